"""The timers of one clock in an EventsExecutor.

Two events precede a timer's callback: first a check of all timers of the clock, and then, behind all events
that arrived meanwhile, the call of each due timer. A check asks only which timers are due, not which calls
are queued already: after two checks before the first call, as when another timer is reset, a timer is called
twice.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import partial

from sim.clock import RunClock
from sim.ros.clocks.clock import Clock
from sim.ros.clocks.jumps import JumpThreshold
from sim.ros.scheduling.entity import NEVER, Entity
from sim.ros.scheduling.event_queue import Appointment, EventQueue
from sim.ros.time.duration import Duration

_ANY_JUMP = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))


class ClockTimers:
    """Queues an event that calls ``call`` for each due timer. Use it with the host's lock held."""

    def __init__(
        self,
        clock: Clock,
        time: RunClock,
        lock: AbstractContextManager[bool],
        queue: EventQueue,
        call: Callable[[Entity], None],
    ) -> None:
        self.timers: dict[Entity, None] = {}
        self._time = time
        self._lock = lock
        self._queue = queue
        self._call = call
        self._queued: set[Entity] = set()
        self._next_check: Appointment | None = None
        self._jumps = clock.create_jump_callback(_ANY_JUMP, post_callback=lambda _: self.check_soon())

    def add(self, timer: Entity) -> None:
        """Add a timer; this checks all timers at once, and later for its resets that nobody heard of.

        Source: ``rcl_timer_set_on_reset_callback`` reports earlier resets.
        """
        self.timers[timer] = None
        if timer.reset_unheard:
            timer.reset_unheard = False
            self.check_soon()
        self._check()

    def remove(self, timer: Entity) -> None:
        """Remove a timer; a queued call of it is skipped."""
        del self.timers[timer]
        if not self.timers:
            self._jumps.unregister()
            self._call_off_check()

    def check_soon(self) -> None:
        """Queue a check of which timers are due."""
        with self._lock:
            self._queue.put(self._check_event)

    def _check_event(self) -> None:
        with self._lock:
            self._check()

    def _check(self) -> None:
        now = self._time.now()
        next_due = NEVER
        due = []
        for timer in self.timers:
            if timer.still_ready(now):
                due.append(timer)
            elif timer.falls_due(timer.due):
                next_due = min(next_due, timer.due)
            timer.node._agenda.next_due()  # drops the due times that are past
        while due:  # rclpy's C++ code has them in an unordered map
            timer = due.pop(self._time.choose(len(due)))
            self._queued.add(timer)
            self._queue.put(partial(self._call_event, timer))
        self._call_off_check()
        if not self._queued and next_due < NEVER:
            self._next_check = self._queue.at(next_due, self.check_soon)

    def _call_off_check(self) -> None:
        if self._next_check is not None:
            self._next_check.call_off()

    def _call_event(self, timer: Entity) -> None:
        with self._lock:
            self._queued.discard(timer)
            if not self._queued:
                self.check_soon()
        if timer in self.timers:
            self._call(timer)
