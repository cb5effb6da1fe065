"""Which thread goes on where a real machine could choose any: first come, first served, or as a seed says.

All choices that a run on virtual time leaves open are made here, and nowhere else; nothing here waits or
knows a clock. Threads are told apart by what the caller hands in for them.
"""

from collections.abc import Hashable, Sequence
from itertools import count
from random import Random
from typing import Protocol


class Schedule(Protocol):
    """Makes the choices of one run. Used by one thread at a time, the one that has the baton."""

    explores: bool
    """Whether it ever chooses anything but the first; if not, nobody has to ask where to switch."""

    def next(self, ready: Sequence[Hashable]) -> int:
        """Which of the threads that can run goes on: a place in ``ready``, oldest first."""

    def leaves(self, running: Hashable, ready: Sequence[Hashable]) -> bool:
        """Whether a thread that could go on lets one of those in ``ready`` go first."""

    def choose(self, number: int) -> int:
        """Which of ``number`` equals is taken, from 0: the first is the one that came first."""

    def forget(self, thread: Hashable) -> None:
        """A thread has ended."""


class FirstCome:
    """First come, first served; a thread goes on until it waits."""

    explores = False

    def next(self, ready: Sequence[Hashable]) -> int:
        """The one that has waited longest."""
        return 0

    def leaves(self, running: Hashable, ready: Sequence[Hashable]) -> bool:
        """Never."""
        return False

    def choose(self, number: int) -> int:
        """The first."""
        return 0

    def forget(self, thread: Hashable) -> None:
        """Nothing is known of it."""


class Seeded:
    """The choices that a seed makes: the same seed, asked the same, always makes the same.

    Every thread gets a random priority when it is first seen, and the highest goes on. At each decision, with
    a probability that the seed draws once, the thread that would go on falls below all others. So some seeds
    keep a thread slow for long, as no series of independent draws would, and others switch all the time.

    This is probabilistic concurrency testing (Burckhardt, Kothari, Musuvathi and Nagarakatte: A Randomized
    Scheduler with Probabilistic Guarantees of Finding Bugs, ASPLOS 2010), with change points that come again
    and again, since nodes run for ever, in place of a fixed number of them.
    """

    explores = True
    _CHANGE_RATES = (0.5, 0.2, 0.05, 0.01)

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)
        self._rate = self._random.choice(self._CHANGE_RATES)
        self._priorities: dict[Hashable, float] = {}
        self._lowest = count(-1, -1)

    def next(self, ready: Sequence[Hashable]) -> int:
        """The one of the highest priority, or, where a change comes, of the second highest."""
        place = self._highest(ready)
        if len(ready) > 1 and self._random.random() < self._rate:
            self._lower(ready[place])
            place = self._highest(ready)
        return place

    def leaves(self, running: Hashable, ready: Sequence[Hashable]) -> bool:
        """Whether one of a higher priority could run, perhaps because of a change here."""
        if self._random.random() < self._rate:
            self._lower(running)
        mine = self._priority(running)
        return any(self._priority(each) > mine for each in ready)

    def choose(self, number: int) -> int:
        """Any of them."""
        return self._random.randrange(number) if number > 1 else 0

    def forget(self, thread: Hashable) -> None:
        """Its priority is not needed any more."""
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
    """The schedule that a seed stands for; None and 0 stand for first come, first served."""
    return Seeded(seed) if seed else FirstCome()
