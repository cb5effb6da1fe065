"""The timers of one clock, as an EventsExecutor looks after them.

A timer is queued twice before its callback runs: first a look at all timers of the clock, then, behind all
that came meanwhile, the call of each that is due. A look asks only who is due, not who is queued already:
with two looks before the first call, as when another timer is reset meanwhile, a timer is called twice.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import partial
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from sim.ros.clocks.jumps import JumpThreshold
from sim.ros.scheduling.entity import NEVER, OwnerNode
from sim.ros.time.duration import Duration

if TYPE_CHECKING:
    from sim.clock import RunClock
    from sim.ros.clocks.clock import Clock
    from sim.ros.scheduling.event_queue import Appointment, EventQueue

_ANY_JUMP = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))


@runtime_checkable
class ClockTimer(Protocol):
    """A timer, as far as a clock's timers know it."""

    clock: Clock
    node: OwnerNode
    due: int

    def still_ready(self, now: int) -> bool:
        """Whether it is due and neither cancelled nor destroyed."""

    def falls_due(self, due: int) -> bool:
        """Whether it still becomes ready at ``due``."""


class ClockTimers:
    """Has ``call`` called, as an event, for each timer that is due. With the host's lock held."""

    def __init__(
        self,
        clock: Clock,
        time: RunClock,
        lock: AbstractContextManager[bool],
        queue: EventQueue,
        call: Callable[[ClockTimer], None],
    ) -> None:
        self.timers: dict[ClockTimer, None] = {}
        self._time = time
        self._lock = lock
        self._queue = queue
        self._call = call
        self._queued: set[ClockTimer] = set()
        self._next_look: Appointment | None = None
        self._jumps = clock.create_jump_callback(_ANY_JUMP, post_callback=lambda _: self.look_soon())

    def add(self, timer: ClockTimer) -> None:
        """Look after a timer; this looks at all at once."""
        self.timers[timer] = None
        self._look()

    def remove(self, timer: ClockTimer) -> None:
        """Look after a timer no more; if it is queued, it is not called."""
        del self.timers[timer]
        if not self.timers:
            self._jumps.unregister()
            self._call_off_look()

    def look_soon(self) -> None:
        """Queue a look at who is due."""
        with self._lock:
            self._queue.put(self._look_event)

    def _look_event(self) -> None:
        with self._lock:
            self._look()

    def _look(self) -> None:
        now = self._time.now()
        next_due = NEVER
        due = []
        for timer in self.timers:
            if timer.still_ready(now):
                due.append(timer)
            elif timer.falls_due(timer.due):
                next_due = min(next_due, timer.due)
            timer.node._agenda.next_due()  # lets go of the due times that are past
        while due:  # rclpy's C++ code keeps them in an unordered map
            timer = due.pop(self._time.choose(len(due)))
            self._queued.add(timer)
            self._queue.put(partial(self._call_event, timer))
        self._call_off_look()
        if not self._queued and next_due < NEVER:
            self._next_look = self._queue.at(next_due, self.look_soon)

    def _call_off_look(self) -> None:
        if self._next_look is not None:
            self._next_look.call_off()

    def _call_event(self, timer: ClockTimer) -> None:
        with self._lock:
            self._queued.discard(timer)
            if not self._queued:
                self.look_soon()
        if timer in self.timers:
            self._call(timer)
