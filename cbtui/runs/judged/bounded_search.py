"""The search through all schedules of a program that have at most so many preemptions."""

from collections.abc import Iterator, Sequence
from heapq import heappop, heappush

from sim.clock.moves import Moves, moves_text
from sim.trace.events import ThreadChosen


class BoundedSearch:
    """An iterator of seeds; ``take`` brings the choices of each run, and with them further seeds.

    It may have a next seed again after it had none. Those with fewer preemptions come first, and of two runs
    that come to the same state only one is followed further: the other can find nothing new. At most
    ``limit`` seeds are given out. Of several ``parts``, each follows its share of the first run's choices; a
    run that several parts come to is in each of them.
    """

    def __init__(self, preemptions: int, limit: int, part: int = 1, parts: int = 1) -> None:
        self._preemptions = preemptions
        self._limit = limit
        self._mine = slice(part - 1, None, parts)
        self._given: dict[str, tuple[int, Moves]] = {}
        self._waiting: list[tuple[int, int, str, Moves]] = []
        self._seen: set[tuple[int, int]] = set()
        self._add(0, {})

    @property
    def is_complete(self) -> bool:
        """Whether no seed is left, once the runs of all that were given out are over."""
        return not self._waiting

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        if not self._waiting or len(self._given) == self._limit:
            raise StopIteration
        used, _, seed, moves = heappop(self._waiting)
        self._given[seed] = used, moves
        return seed

    def preempted(self, seed: str) -> int:
        """How many preemptions a seed that was given out has."""
        return self._given[seed][0]

    def take(self, seed: str, _failures: object, choices: Sequence[ThreadChosen]) -> None:
        """Add what can be chosen otherwise behind the last move of a run."""
        used, moves = self._given[seed]
        found: list[tuple[int, Moves]] = []
        for choice in choices:
            if choice.number <= max(moves, default=-1):
                continue
            if (choice.state, used) in self._seen:
                break
            self._seen.add((choice.state, used))
            more = used + choice.preempts
            if more <= self._preemptions:
                found += [(more, {**moves, choice.number: option}) for option in range(1, choice.able)]
        for more, each in found if moves else found[self._mine]:
            self._add(more, each)

    def _add(self, used: int, moves: Moves) -> None:
        heappush(self._waiting, (used, len(moves), moves_text(moves), moves))
