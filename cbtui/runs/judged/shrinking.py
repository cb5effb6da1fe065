"""The search for a simple schedule with the same failure as one that was found by sampling."""

from collections.abc import Collection, Hashable, Iterator, Sequence
from itertools import count
from math import inf

from sim.clock.moves import Moves, moves_text
from sim.trace.events import ThreadChosen


class Shrinking:
    """An iterator of seeds; ``take`` receives the failures and choices of each run.

    Random moves come first, until a run has one of ``failures``. Then moves are left out, many at a time at
    first, as long as the failure remains (delta debugging). There may be a next seed again after
    StopIteration. At most ``limit`` seeds are returned. Each of several ``parts`` makes other random moves.
    """

    def __init__(self, failures: Collection[Hashable], limit: int, part: int = 1, parts: int = 1) -> None:
        self._failures = frozenset(failures)
        self._left = limit
        self._walks = count(part, parts)
        self._rank: tuple[int, int, float] | None = None
        self._size = 0
        self._fewer: Iterator[str] = iter(())
        self._tried: set[str] = set()
        """The seeds given out that play moves."""
        self.best = ""
        """The simplest that has failed: the fewest preemptions, then the fewest moves; "" for none."""

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        if not self._left:
            raise StopIteration
        seed = f"walk:{next(self._walks)}" if self._rank is None else next(self._fewer)
        self._left -= 1
        return seed

    @property
    def preempted(self) -> int:
        """The number of preemptions of the simplest."""
        return 0 if self._rank is None else self._rank[0]

    def take(self, seed: str, failures: Collection[Hashable], choices: Sequence[ThreadChosen]) -> None:
        """Continue from a run if it has failed and is simpler than the simplest so far."""
        chosen = [choice for choice in choices if choice.chosen]
        is_played = seed in self._tried
        rank = sum(choice.preempts for choice in chosen), len(chosen), len(seed) if is_played else inf
        common = self._failures.intersection(failures)
        if not common or (self._rank is not None and rank >= self._rank):
            return
        self._failures = common
        moves = {choice.number: choice.chosen for choice in chosen}
        if not self._size:
            self._size = len(moves)
        self._rank = rank
        if is_played:
            self.best = seed
        self._fewer = self._leave_out(moves)

    def _leave_out(self, moves: Moves) -> Iterator[str]:
        """Yield the moves, then those without some, the latest first; half as many when all were tried."""
        yield from self._untried(moves)
        while self._size:
            numbers = sorted(moves, reverse=True)
            for first in range(0, len(numbers), self._size):
                left_out = numbers[first : first + self._size]
                yield from self._untried({each: moves[each] for each in numbers if each not in left_out})
            self._size //= 2

    def _untried(self, moves: Moves) -> Iterator[str]:
        text = moves_text(moves)
        if text not in self._tried:
            self._tried.add(text)
            yield text
