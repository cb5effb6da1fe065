"""Finds threads that wait without a timeout for an action that no other thread will take."""

import threading
from collections.abc import Callable
from dataclasses import dataclass

from sim.clock import VirtualClock
from sim.clock.lock_cycles import cycle_of, lasts
from sim.clock.virtual_threads import HeldResource, VirtualThread
from sim.engine.watchdogs.wait_descriptions import deadlock_of_cycle, deadlock_of_last, long_wait
from sim.ros.middleware.host import Host
from sim.ros.middleware.process import Process, current_process, process_of
from sim.trace.events import AnyEvent, EntityId

_PATIENCE = 3_000_000_000
"""Virtual nanoseconds after which a callback's wait is reported although it might still end."""
_SETTLES = 100_000_000
"""Virtual nanoseconds that a cycle of waits, perhaps for signals, must have lasted at the run's end."""


@dataclass(eq=False)
class _ThreadWait:
    """A thread's wait without a timeout; ``entity`` is the callback that it runs, 0 for none.

    ``other`` is a thread of the program that did not wait at the last check.
    """

    thread: VirtualThread
    wants: HeldResource | None
    process: Process
    entity: EntityId
    since: int
    other: VirtualThread | None = None
    told: bool = False


class EndlessWaits:
    """Watches the waits of programs' threads, and reports each faulty wait once.

    A deadlock is reported where it is certain: if threads wait for locks in a cycle that no other thread can
    open, or if all threads of a program wait. Any other wait of a callback is reported when it has lasted
    long, and a cycle of waits that may be for signals at the end of the run.
    """

    def __init__(self, clock: VirtualClock, host: Host, record: Callable[[AnyEvent], None]) -> None:
        self._clock = clock
        self._host = host
        self._record = record
        self._waits: dict[VirtualThread, _ThreadWait] = {}
        self._deadlocked = False

    def begins(self, thread: VirtualThread) -> None:
        """Note that a thread waits for a lock or a thread's end; the clock calls this on that thread."""
        process = current_process()
        entity = (process.probe or self._host.probe).callback_here()
        cycle = cycle_of(thread)
        if not (cycle or entity or thread.is_main):
            return
        wait = _ThreadWait(thread, thread.wants, process, entity, self._clock.now())
        self._waits[thread] = wait
        if lasts(cycle):
            self._tell_of_deadlock(wait, cycle)

    def look(self) -> int | None:
        """Check the waits; call it whenever time is about to pass.

        Returns when the next one will have lasted long, if it is not over by then; None for none.
        """
        due = []
        for wait in self._standing():
            if (wait.entity or not self._deadlocked) and self._is_last(wait):
                self._tell_of_deadlock(wait, cycle_of(wait.thread))
            elif wait.entity and not wait.told and self._lasted(wait) < _PATIENCE:
                due.append(wait.since + _PATIENCE)
            elif wait.entity and not wait.told:
                wait.told = True
                self._record(long_wait(wait.thread, wait.since).notice(self._clock.now(), wait.entity))
        return min(due, default=None)

    def finish(self) -> None:
        """Check the waits for the last time, at the end of the run."""
        self.look()
        for wait in self._standing():
            cycle = cycle_of(wait.thread)
            if cycle and wait.thread in self._waits and self._lasted(wait) >= _SETTLES:
                self._tell_of_deadlock(wait, cycle)

    def _standing(self) -> list[_ThreadWait]:
        """Return the waits that have not ended, those of callbacks first; forget the others."""
        waits = list(self._waits.values())
        for wait in waits:
            if wait.thread.wants is not wait.wants:
                del self._waits[wait.thread]
        standing = [wait for wait in waits if wait.thread.wants is wait.wants]
        return sorted(standing, key=lambda wait: not wait.entity)

    def _lasted(self, wait: _ThreadWait) -> int:
        return self._clock.now() - wait.since

    def _is_last(self, wait: _ThreadWait) -> bool:
        """Return whether all threads of a wait's program wait."""
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

    def _tell_of_deadlock(self, wait: _ThreadWait, cycle: list[VirtualThread]) -> None:
        self._deadlocked = True
        told = deadlock_of_cycle(cycle) if cycle else deadlock_of_last(wait.thread)
        self._record(told.notice(self._clock.now(), wait.entity))
        for each in cycle or [wait.thread]:
            self._waits.pop(each, None)
