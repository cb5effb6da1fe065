"""Looks for choices of the model's threads with which it goes as a real run did."""

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice, repeat
from random import Random
from typing import NamedTuple

from tests.conformance.comparing import DIFFERENT, Outcome, Result, on_model, outcome, words_of
from tests.conformance.running import Said
from tests.conformance.steered import Choice, Steering


def searched(results: Iterable[Result], distro: str, runs: int) -> list[Result]:
    """The same results, but REACHED where at most so many runs of the model find what a real run said."""
    return [
        each._replace(outcome=Outcome.REACHED)
        if each.outcome in (*DIFFERENT, Outcome.BUSY) and Search(each, distro).finds(runs)
        else each
        for each in results
    ]


class _Way(NamedTuple):
    """What a try follows, and whether the threads of pools race in it."""

    real: Said
    races: bool


class Search:
    """Goes on from runs that are alike for long: back by a few lines, then any choices.

    Each try follows one real run: a thread that would say another line than this run's next one is left
    before it, so a try ends where no thread can come to the next line. What decides that is often chosen
    some lines before. Half of the tries go on from what is alike for less long, since what is longest so
    may be a dead end.
    """

    def __init__(self, result: Result, distro: str) -> None:
        self._case = result.case
        self._real = result.real
        self._distro = distro
        self._known: dict[int, list[tuple[_Way, tuple[Choice, ...]]]] = defaultdict(list)
        """By how many lines are alike, what was tried, and the choices up to there."""
        self._random = Random(2)
        self._seen: set[tuple[object, ...]] = set()
        self._tried: deque[_Way] = deque()

    def finds(self, runs: int) -> bool:
        """Whether one of so many runs of the model goes as a real one."""
        said = on_model(repeat(self._case.system), self._distro, self._next(), at_once=1)
        return any(model is not None and self._is_it(model) for model in islice(said, runs))

    def _next(self) -> Iterator[Steering]:
        """What to try next."""
        for races in (False, True):
            for real in self._real:
                yield self._steering(_Way(real, races))
        while self._known:
            alike, *others = sorted(self._known, reverse=True)
            while others and self._random.random() < 0.5:
                alike, *others = others
            way, choices = self._random.choice(self._known[alike])
            line = alike
            while line and self._random.random() < 0.75:
                line -= 1
            before, here = (sum(each.line in lines for each in choices) for lines in (range(line), [line]))
            kept = choices[: before + self._random.randrange(here + 1)]
            yield self._steering(way, [each.chosen for each in kept], self._random.getrandbits(32))

    def _steering(self, way: _Way, chosen: Sequence[int] = (), seed: int | None = None) -> Steering:
        self._tried.append(way)
        return Steering(chosen, seed, [*words_of(self._case.system, way.real).values()], way.races)

    def _is_it(self, model: Said) -> bool:
        way = self._tried.popleft()
        if outcome(self._case._replace(model=model), [way.real]) is Outcome.SAME:
            return True
        run = (way, model.words, tuple(each[:2] for each in model.choices))
        if model.choices and run not in self._seen:
            self._seen.add(run)
            self._known[len(model.words)].append((way, model.choices))
        return False
