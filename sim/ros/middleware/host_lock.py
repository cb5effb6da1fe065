"""The lock of a host: a polling lock, and a lock that is a switch point of explored runs."""

import threading
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from types import TracebackType

from sim.clock import RunClock, VirtualClock
from sim.clock.schedule import NO_ACCESSES

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_RLock = threading.RLock
_sleep = time.sleep

_RETRY = 50e-6
"""Seconds between two attempts to take the lock."""


class HostLock(type(_RLock())):  # type: ignore[misc]
    """A lock without a queue: a thread that finds the lock held sleeps and retries.

    The lock is held only for a few lines, so a thread finds it held only if the interpreter switched threads
    meanwhile. With a queue, threads would hand the lock over at every later use, each time with a thread
    switch.
    """

    def __enter__(self) -> bool:
        while not self.acquire(False):
            _sleep(_RETRY)
        return True


class SwitchedLock:
    """The lock of a host on a virtual clock that explores orders: threads switch before and after each use.

    Threads never switch while one holds the lock; a thread that finds it held waits in real time. Reentrant.
    ``in_callback`` returns whether the calling thread runs a callback: then the use is a step of the program.
    """

    def __init__(self, clock: VirtualClock, in_callback: Callable[[], object]) -> None:
        self._clock = clock
        self._in_callback = in_callback
        self._lock = HostLock()

    def __enter__(self) -> bool:
        self._clock.switch_point({self: True} if self._in_callback() else NO_ACCESSES)
        self._lock.__enter__()
        self._clock.record_use(self)
        if self._clock.owns_current_thread():
            self._clock.no_switching += 1
        return True

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._clock.owns_current_thread():
            self._clock.no_switching -= 1
        self._lock.release()
        self._clock.switch_point()


def lock_on(clock: RunClock, in_callback: Callable[[], object]) -> AbstractContextManager[bool]:
    """Make the lock of a host with that clock; ``in_callback`` is as for ``SwitchedLock``."""
    if isinstance(clock, VirtualClock) and clock.explores:
        return SwitchedLock(clock, in_callback)
    return HostLock()
