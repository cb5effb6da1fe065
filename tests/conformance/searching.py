"""Looks for choices of the model's threads with which it goes as a real run did."""

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator
from functools import partial
from heapq import heappop, heappush
from itertools import groupby, islice
from random import Random

from sim.clock.moves import Moves
from tests.conformance.comparing import DIFFERENT, Outcome, Result, on_model, outcome, place_of, words_of
from tests.conformance.running import Said

_RUNS_AT_ONCE = 12


def searched(results: Iterable[Result], distro: str, runs: int) -> list[Result]:
    """The same results, but REACHED where at most so many runs of the model find what a real run said."""
    return [
        each._replace(outcome=Outcome.REACHED)
        if each.outcome in (*DIFFERENT, Outcome.BUSY) and Search(each, distro).finds(runs)
        else each
        for each in results
    ]


class Search:
    """Best first, mostly: what goes longest as a real run is tried with one choice more.

    Half of the tries go on from what is alike for less long, since what is longest so may be a dead end. A
    thread is often left at several places in turn with the same effect, so the places within a stretch are
    tried spread out, not in a row; and runs that go on alike behind their last choice are followed once.
    """

    def __init__(self, result: Result, distro: str) -> None:
        self._case = result.case
        self._real = result.real
        self._distro = distro
        self._untried: dict[int, list[tuple[float, float, Moves]]] = defaultdict(list, {0: [(0.0, 0.0, {})]})
        """By how many lines are alike, each a heap: the cheapest first."""
        self._random = Random(1)
        self._followed: set[tuple[object, ...]] = set()

    def finds(self, runs: int) -> bool:
        """Whether one of so many runs of the model goes as a real one."""
        for _ in range(0, runs, _RUNS_AT_ONCE):
            tried = list(islice(self._next(), _RUNS_AT_ONCE))
            said = on_model([self._case.system] * len(tried), self._distro, tried)
            for moves, model in zip(tried, said, strict=True):
                if model is not None and self._is_it(moves, model):
                    return True
        return False

    def _next(self) -> Iterator[Moves]:
        """What to try next, as long as there is anything."""
        while levels := sorted((alike for alike, untried in self._untried.items() if untried), reverse=True):
            best, *others = levels
            while others and self._random.random() < 0.5:
                best, *others = others
            yield heappop(self._untried[best])[-1]

    def _is_it(self, moves: Moves, model: Said) -> bool:
        if outcome(self._case._replace(model=model), list(self._real)) is Outcome.SAME:
            return True
        alike, place = max(self._alike(model, real) for real in self._real)
        last = max(moves, default=-1)
        behind = (model.words, model.choices[last + 1 :])
        if behind in self._followed:
            return False
        self._followed.add(behind)
        left = range(last + 1, len(model.choices))
        for (said, options, preempts), stretch in groupby(left, model.choices.__getitem__):
            if said > place:
                break
            preemptions = sum(model.choices[each][2] for each in moves) + preempts
            cost = len(moves) + 2 * preemptions + 0.1 * (place - said)
            for turn, number in enumerate(_spread_out(list(stretch))):
                for option in range(1, options):
                    rank = (cost + 0.15 * turn.bit_length(), self._random.random())
                    heappush(self._untried[alike], (*rank, {**moves, number: option}))
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


def _spread_out(numbers: list[int]) -> list[int]:
    """Consecutive numbers in another order, so that any first few of them are far apart."""
    return sorted(numbers, key=lambda each: f"{each - numbers[0]:020b}"[::-1])
