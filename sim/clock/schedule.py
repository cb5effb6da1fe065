"""Chooses the thread that goes on where a real machine could choose any: by arrival, or by a seed.

All choices that a run on virtual time leaves open are made here; nothing here waits or knows a clock. The
caller decides what identifies a thread.
"""

from collections.abc import Hashable, Sequence
from itertools import count
from random import Random
from typing import Protocol


class Schedule(Protocol):
    """Makes the choices of one run. Used by one thread at a time, the one that has the baton."""

    explores: bool
    """Whether it may choose anything but the first; if not, nobody has to offer it a switch."""

    def next(self, ready: Sequence[Hashable]) -> int:
        """The index in ``ready``, oldest first, of the thread that goes on."""

    def leaves(self, running: Hashable, ready: Sequence[Hashable]) -> bool:
        """Whether a thread that could go on lets one of ``ready`` go first."""

    def choose(self, number: int) -> int:
        """The index of the chosen one of ``number`` equals; 0 came first."""

    def forget(self, thread: Hashable) -> None:
        """A thread has ended."""


class FirstCome:
    """First come, first served; a thread goes on until it waits."""

    explores = False

    def next(self, ready: Sequence[Hashable]) -> int:
        """The thread that has waited longest."""
        return 0

    def leaves(self, running: Hashable, ready: Sequence[Hashable]) -> bool:
        """Never."""
        return False

    def choose(self, number: int) -> int:
        """The first."""
        return 0

    def forget(self, thread: Hashable) -> None:
        """Nothing to do."""


class Seeded:
    """The choices of a seed: the same seed and the same questions give the same answers.

    Every thread gets a random priority when it is first seen, and the highest goes on. At each decision, with
    a probability that the seed draws once, the thread that would go on falls below all others. So some seeds
    keep a thread slow for long, as no series of independent draws would, and others switch all the time.

    This is probabilistic concurrency testing (Burckhardt, Kothari, Musuvathi and Nagarakatte: A Randomized
    Scheduler with Probabilistic Guarantees of Finding Bugs, ASPLOS 2010), with recurring change points, since
    nodes run for ever, in place of a fixed number of them.
    """

    explores = True
    _CHANGE_RATES = (0.5, 0.2, 0.05, 0.01)

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)
        self._rate = self._random.choice(self._CHANGE_RATES)
        self._priorities: dict[Hashable, float] = {}
        self._lowest = count(-1, -1)

    def next(self, ready: Sequence[Hashable]) -> int:
        """The thread of the highest priority, or, at a change point, of the second highest."""
        place = self._highest(ready)
        if len(ready) > 1 and self._random.random() < self._rate:
            self._lower(ready[place])
            place = self._highest(ready)
        return place

    def leaves(self, running: Hashable, ready: Sequence[Hashable]) -> bool:
        """Whether a thread of a higher priority could run, perhaps because of a change point here."""
        if self._random.random() < self._rate:
            self._lower(running)
        mine = self._priority(running)
        return any(self._priority(each) > mine for each in ready)

    def choose(self, number: int) -> int:
        """Any of them."""
        return self._random.randrange(number) if number > 1 else 0

    def forget(self, thread: Hashable) -> None:
        """Drop its priority."""
        self._priorities.pop(thread, None)

    def _highest(self, ready: Sequence[Hashable]) -> int:
        return max(range(len(ready)), key=lambda place: self._priority(ready[place]))

    def _priority(self, thread: Hashable) -> float:
        known = self._priorities.get(thread)
        if known is None:
            known = self._priorities[thread] = self._random.random()
        return known

    def _lower(self, thread: Hashable) -> None:
        self._priorities[thread] = next(self._lowest)


def schedule_of(seed: int | None) -> Schedule:
    """The schedule of a seed; None and 0 mean first come, first served."""
    return Seeded(seed) if seed else FirstCome()
