"""The search through all schedules of a program with a bounded number of preemptions."""

from collections.abc import Iterator, Mapping, Sequence
from heapq import heappop, heappush
from typing import NamedTuple

from sim.clock.moves import Moves, moves_text
from sim.trace.events import ThreadChosen


class Branch(NamedTuple):
    """A choice of a run at which the search can continue; the fields are those of ``ThreadChosen``."""

    number: int
    able: int
    preempts: bool
    state: int


class BoundedSearch:
    """An iterator of seeds; ``take`` receives the choices of each run, which lead to further seeds.

    It may have a next seed again after StopIteration. Seeds with fewer preemptions come first. Of two runs
    that reach the same state only one is continued: the other can find nothing new. Where several run at
    once, which one depends on which ends first; so the search goes on until it has made all runs that one
    after the other would make, and these are ``counted``. At most ``limit`` seeds are returned. Each of
    several ``parts`` follows its share of the first run's choices. A run that several parts reach is in each
    of them, with all that follows from it; ``of_all_parts`` returns those that a search in one part counts.
    """

    def __init__(self, preemptions: int, limit: int, part: int = 1, parts: int = 1) -> None:
        self._preemptions = preemptions
        self._limit = limit
        self._part, self._parts = part, parts
        self._given: dict[str, tuple[int, Moves]] = {}
        self._waiting: list[tuple[int, int, str, Moves]] = []
        self._seen: set[tuple[int, int]] = set()
        self.branches: dict[str, tuple[Branch, ...]] = {}
        """The branches of each run that was taken, behind its last move."""
        self._add(0, {})

    @property
    def is_complete(self) -> bool:
        """Whether no seed is left; final once the runs of all returned seeds are over."""
        return not self._waiting

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        if not self._waiting:
            _, left_out = self._one_by_one(self.branches)
            if left_out is not None and moves_text(left_out[1]) not in self._given:
                self._add(*left_out)
        if not self._waiting or len(self._given) == self._limit:
            raise StopIteration
        return self._pop()

    @property
    def counted(self) -> list[str]:
        """The seeds of the runs that one after the other would make, as far as they are made."""
        return self._one_by_one(self.branches)[0]

    def _one_by_one(
        self, branches: Mapping[str, tuple[Branch, ...]]
    ) -> tuple[list[str], tuple[int, Moves] | None]:
        """Search among the runs of ``branches``; also return the first that is needed and not among them."""
        search = BoundedSearch(self._preemptions, self._limit, self._part, self._parts)
        while search._waiting:
            seed = search._pop()
            if seed not in branches:
                return list(search.branches), search._given[seed]
            search.follow(seed, branches[seed])
        return list(search.branches), None

    def _pop(self) -> str:
        used, _, seed, moves = heappop(self._waiting)
        self._given[seed] = used, moves
        return seed

    def preempted(self, seed: str) -> int:
        """The number of preemptions of a returned seed."""
        return self._given[seed][0]

    def take(self, seed: str, _failures: object, choices: Sequence[ThreadChosen]) -> None:
        """Add the seeds that choose differently after the last move of a run."""
        last = max(self._given[seed][1], default=-1)
        self.follow(
            seed,
            tuple(
                Branch(choice.number, choice.able, choice.preempts, choice.state)
                for choice in choices
                if choice.number > last
            ),
        )

    def follow(self, seed: str, branches: tuple[Branch, ...]) -> None:
        """Do what ``take`` does, from the branches after the last move of a run."""
        self.branches[seed] = branches
        used, moves = self._given[seed]
        found: list[tuple[int, Moves]] = []
        for number, able, preempts, state in branches:
            if (state, used) in self._seen:
                break
            self._seen.add((state, used))
            more = used + preempts
            if more <= self._preemptions:
                found += [(more, {**moves, number: option}) for option in range(1, able)]
        for more, each in found if moves else found[self._part - 1 :: self._parts]:
            self._add(more, each)

    def _add(self, used: int, moves: Moves) -> None:
        heappush(self._waiting, (used, len(moves), moves_text(moves), moves))


def of_all_parts(preemptions: int, branches: Mapping[str, tuple[Branch, ...]]) -> list[str]:
    """Return the seeds of a search in one part, from the branches of all runs of its parts.

    These are all the seeds if a part has left out a run which another part's runs make needless there.
    """
    seeds, left_out = BoundedSearch(preemptions, len(branches))._one_by_one(branches)
    return seeds if left_out is None else list(branches)
