"""Notices threads that wait for each other's locks for ever, and names the places."""

from collections.abc import Callable

from sim.clock import VirtualClock
from sim.clock.circles import circle_of
from sim.clock.virtual_threads import VirtualThread
from sim.engine.watchdog import place_of
from sim.trace.events import AnyEvent, Notice, Severity

_SETTLES = 100_000_000
"""Virtual nanoseconds after which a circle is taken for one that nobody opens."""


class LockCircles:
    """Looks at a circle of threads again a little later, and tells the person if it still stands."""

    def __init__(self, clock: VirtualClock, record: Callable[[AnyEvent], None]) -> None:
        self._clock = clock
        self._record = record

    def look(self, thread: VirtualThread) -> None:
        """A thread begins to wait for a lock; the clock's locks call this on that thread."""
        circle = circle_of(thread)
        if circle:
            waits = [each.current_wait for each in circle[1:]]
            self._clock.call_at(self._clock.now() + _SETTLES, lambda: self._tell(circle, waits))

    def _tell(self, circle: list[VirtualThread], waits: list[int]) -> None:
        if circle_of(circle[0]) == circle and [each.current_wait for each in circle[1:]] == waits:
            self._record(Notice(self._clock.now(), Severity.ERROR, _sentence(circle)))


def _sentence(circle: list[VirtualThread]) -> str:
    first, *others = (f"{each.name} ({place_of(each)})" for each in circle)
    chain = "".join(f" waits for a lock of {each}, which" for each in others)
    closing = f" waits for a lock of {circle[0].name}"
    return f"deadlock: {first}{chain}{closing}; take locks in the same order everywhere"
