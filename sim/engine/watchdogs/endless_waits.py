"""Finds threads that wait without a timeout for what no other thread will do."""

import threading
from collections.abc import Callable
from dataclasses import dataclass

from sim.clock import VirtualClock
from sim.clock.lock_cycles import cycle_of, lasts
from sim.clock.virtual_threads import HeldResource, VirtualThread
from sim.engine.watchdogs.wait_descriptions import deadlock_of_circle, deadlock_of_last, long_wait
from sim.ros.middleware.host import Host
from sim.ros.middleware.process import Process, current_process, process_of
from sim.trace.events import AnyEvent, EntityId

_PATIENCE = 3_000_000_000
"""Virtual nanoseconds after which a callback's wait is reported although something might still end it."""
_SETTLES = 100_000_000
"""Virtual nanoseconds that a circle of what could be signals must have lasted when the run ends."""


@dataclass(eq=False)
class _Wait:
    """What a thread of a program waits for without an end. ``entity``: whose callback it runs, 0: none.

    ``other`` is a thread of the program that could do something when that was last looked for.
    """

    thread: VirtualThread
    wants: HeldResource | None
    process: Process
    entity: EntityId
    since: int
    other: VirtualThread | None = None
    told: bool = False


class EndlessWaits:
    """Looks at what the threads of programs wait for, and says of each wait once what is wrong with it.

    A deadlock is told where it is sure: where threads wait for locks in a circle that nobody opens from
    outside, and where a thread waits and every other one of its program does so too. What a callback waits
    for otherwise is told when that has lasted long, and circles of what could be signals as the run ends.
    """

    def __init__(self, clock: VirtualClock, host: Host, record: Callable[[AnyEvent], None]) -> None:
        self._clock = clock
        self._host = host
        self._record = record
        self._waits: dict[VirtualThread, _Wait] = {}
        self._deadlocked = False

    def begins(self, thread: VirtualThread) -> None:
        """A thread begins to wait for a lock or another thread's end; the clock calls this on that thread."""
        process = current_process()
        entity = (process.probe or self._host.probe).callback_here()
        circle = cycle_of(thread)
        if not (circle or entity or thread.is_main):
            return
        wait = _Wait(thread, thread.wants, process, entity, self._clock.now())
        self._waits[thread] = wait
        if lasts(circle):
            self._tell_of_deadlock(wait, circle)

    def look(self) -> None:
        """Look at the waits; call it whenever time is about to pass."""
        for wait in self._standing():
            if (wait.entity or not self._deadlocked) and self._is_last(wait):
                self._tell_of_deadlock(wait, cycle_of(wait.thread))
            elif wait.entity and not wait.told and self._lasted(wait) >= _PATIENCE:
                wait.told = True
                self._record(
                    long_wait(wait.thread, self._lasted(wait)).notice(self._clock.now(), wait.entity)
                )

    def finish(self) -> None:
        """Look for the last time: the run is over."""
        self.look()
        for wait in self._standing():
            circle = cycle_of(wait.thread)
            if circle and wait.thread in self._waits and self._lasted(wait) >= _SETTLES:
                self._tell_of_deadlock(wait, circle)

    def _standing(self) -> list[_Wait]:
        """Those that have not ended, callbacks' first; the others are forgotten."""
        waits = list(self._waits.values())
        for wait in waits:
            if wait.thread.wants is not wait.wants:
                del self._waits[wait.thread]
        standing = [wait for wait in waits if wait.thread.wants is wait.wants]
        return sorted(standing, key=lambda wait: not wait.entity)

    def _lasted(self, wait: _Wait) -> int:
        return self._clock.now() - wait.since

    def _is_last(self, wait: _Wait) -> bool:
        """Whether no thread of a wait's program can do anything but end."""
        alive = self._clock.threads
        if wait.other is None or wait.other not in alive or wait.other.wants is not None:
            known = {each.ident: each for each in threading.enumerate()}
            wait.other = next(
                (
                    each
                    for each in alive
                    if each.wants is None
                    and (each.ident not in known or process_of(known[each.ident]) is wait.process)
                ),
                None,
            )
        return wait.other is None

    def _tell_of_deadlock(self, wait: _Wait, circle: list[VirtualThread]) -> None:
        self._deadlocked = True
        told = deadlock_of_circle(circle) if circle else deadlock_of_last(wait.thread)
        self._record(told.notice(self._clock.now(), wait.entity))
        for each in circle or [wait.thread]:
            self._waits.pop(each, None)
