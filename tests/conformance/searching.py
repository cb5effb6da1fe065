"""Looks for choices of the model's threads with which it goes as a real run did."""

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator
from functools import partial
from itertools import islice, repeat
from random import Random

from tests.conformance.comparing import DIFFERENT, Outcome, Result, on_model, outcome, place_of, words_of
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


class Search:
    """Goes on from runs that are alike for long: back by a few lines, one other choice, then any choices.

    An order mostly needs several choices, of which nothing is seen before the last one, so what comes behind
    the other choice is random, to the end of the run. Half of the tries go on from what is alike for less
    long, since what is longest so may be a dead end.
    """

    def __init__(self, result: Result, distro: str) -> None:
        self._case = result.case
        self._real = result.real
        self._distro = distro
        self._known: dict[int, list[tuple[Choice, ...]]] = defaultdict(list)
        """By how many lines are alike, the choices up to there."""
        self._random = Random(2)
        self._seen: set[tuple[object, ...]] = set()

    def finds(self, runs: int) -> bool:
        """Whether one of so many runs of the model goes as a real one."""
        said = on_model(repeat(self._case.system), self._distro, self._next(), at_once=1)
        return any(model is not None and self._is_it(model) for model in islice(said, runs))

    def _next(self) -> Iterator[Steering]:
        """What to try next."""
        yield Steering()
        while self._known:
            alike, *others = sorted(self._known, reverse=True)
            while others and self._random.random() < 0.5:
                alike, *others = others
            choices = self._random.choice(self._known[alike])
            line = choices[-1].line
            while line and self._random.random() < 0.6:
                line -= 1
            line = max((each.line for each in choices if each.line <= line), default=choices[0].line)
            place = self._random.choice([place for place, each in enumerate(choices) if each.line == line])
            chosen = [each.chosen for each in choices[: place + 1]]
            chosen[place] = self._random.choice([*{*range(choices[place].options)} - {chosen[place]}])
            yield Steering(chosen, self._random.getrandbits(32))

    def _is_it(self, model: Said) -> bool:
        if outcome(self._case._replace(model=model), list(self._real)) is Outcome.SAME:
            return True
        alike, first = max(self._alike(model, real) for real in self._real)
        choices = tuple(each for each in model.choices if each.line <= first)
        run = (model.words[: first + 1], tuple(each[:2] for each in choices))
        if choices and run not in self._seen:
            self._seen.add(run)
            self._known[alike].append(choices)
        return False

    def _alike(self, model: Said, real: Said) -> tuple[int, int]:
        """How many lines are alike up to the first of each executor that is not, and where the first is."""
        executor_of = partial(place_of, self._case.system)
        left = {place: deque(words) for place, words in words_of(self._case.system, real).items()}
        alike, first = 0, len(model.words)
        for place, word in enumerate(model.words):
            words = left[executor_of(word)]
            if words and words[0] == word:
                words.popleft()
                alike += 1
            else:
                words.clear()
                first = min(first, place)
        return alike, first
