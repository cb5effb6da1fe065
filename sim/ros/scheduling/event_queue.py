"""The queue of an EventsExecutor's events, in the order of their arrival."""

from collections import deque
from collections.abc import Callable
from contextlib import AbstractContextManager
from heapq import heappop, heappush
from itertools import count
from typing import TypeAlias

from sim.clock import RunClock

Event: TypeAlias = Callable[[], None]
"""An action that runs without the host's lock."""


class Appointment:
    """An action that ``EventQueue.at`` runs later, unless it is cancelled."""

    __slots__ = ("action",)

    def __init__(self, action: Callable[[], None]) -> None:
        self.action: Callable[[], None] | None = action

    def call_off(self) -> None:
        """Cancel the action."""
        self.action = None


class EventQueue:
    """Events, first come, first served. Call everything but ``next`` with the host's lock held."""

    def __init__(self, clock: RunClock, lock: AbstractContextManager[bool]) -> None:
        self.stopped = False
        """Whether ``next`` returns no more events."""
        self._clock = clock
        self._lock = lock
        self._events: deque[Event] = deque()
        self._appointments: list[tuple[int, int, Appointment]] = []
        self._numbers = count()
        self._signal = clock.auto_reset_event()
        self._waiting = False

    def put(self, event: Event) -> None:
        """Add an event, after the actions that are due before it."""
        if self._appointments:
            self._keep_appointments(self._clock.now())
        self._events.append(event)
        self._wake()

    def at(self, due: int, action: Callable[[], None]) -> Appointment:
        """Run ``action``, which may add events, at a time, with the lock held, also while an event runs."""
        made = Appointment(action)
        heappush(self._appointments, (due, next(self._numbers), made))
        self._wake()
        return made

    def stop(self) -> None:
        """Return no more events; the present one runs to its end."""
        self.stopped = True
        self._wake()

    def next(self, deadline: int | None) -> Event | None:
        """Wait for the next event until ``deadline``; None: the queue was stopped, or the deadline passed."""
        while True:
            with self._lock:
                self._waiting = False
                now = self._clock.now()
                self._keep_appointments(now)
                if self.stopped:
                    return None
                if self._events:
                    return self._events.popleft()
                if deadline is not None and deadline <= now:
                    return None
                dues = [due for due in (deadline, self._next_appointment()) if due is not None]
                self._waiting = True
            if not (self._events or self.stopped):  # of a signal that has just come
                self._signal.wait(min(dues, default=None))

    def _wake(self) -> None:
        if self._waiting:
            self._signal.set()

    def _next_appointment(self) -> int | None:
        while self._appointments and self._appointments[0][2].action is None:
            heappop(self._appointments)
        return self._appointments[0][0] if self._appointments else None

    def _keep_appointments(self, now: int) -> None:
        kept = []
        while (due := self._next_appointment()) is not None and due <= now:
            kept.append(heappop(self._appointments)[2])
        for appointment in kept:  # all are taken out first: what an action puts comes before the next action
            if appointment.action is not None:
                appointment.action()
