"""The schedule of a run on virtual time: which thread continues where a real machine could continue several.

All choices that a run leaves open are made by its schedule. A schedule never waits and knows no clock; the
caller decides what identifies a thread.
"""

from collections.abc import Hashable, Mapping, Sequence
from types import MappingProxyType
from typing import TypeAlias

Seed: TypeAlias = int | str
"""What names a schedule; ``sim.clock.strategies.schedule_of`` reads it."""
Accesses: TypeAlias = Mapping[Hashable, bool]
"""The data that a step of a thread shares with other threads, each with whether the step writes it."""
NO_ACCESSES: Accesses = MappingProxyType({})


class Schedule:
    """First come, first served: a thread runs until it waits. Subclasses explore other orders.

    One thread uses a schedule at a time: the one that has the baton.
    """

    explores = False
    """Whether the schedule may choose another thread than the oldest; if not, switch points do not ask it."""

    def next(self, ready: Sequence[Hashable]) -> int:
        """The index of the thread that runs next; ``ready`` is sorted by waiting time, longest first."""
        return 0

    def yields(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """Whether the running thread, which could continue, lets a thread of ``ready`` run first.

        ``accesses`` is what its next step touches, if that step is one of the program's own.
        """
        return False

    def choose(self, number: int) -> int:
        """The index of the chosen one of ``number`` equal candidates; 0 came first."""
        return 0

    def races(self) -> bool:
        """Whether the threads of a pool race, one step of rclpy at a time, or go on as they mostly do."""
        return False

    def lateness(self) -> int:
        """The nanoseconds by which a wait with a deadline ends late."""
        return 0

    def stall(self) -> int:
        """The nanoseconds, at most to the next deadline, that pass although a thread could go on."""
        return 0

    def hands_over(self) -> bool:
        """Whether a released lock goes to a waiting thread; otherwise the next thread that asks gets it."""
        return True

    def record_use(self, thread: Hashable, what: Hashable) -> None:
        """A thread used ``what``; called only if the schedule ``explores``."""

    def forget(self, thread: Hashable) -> None:
        """A thread has ended."""
