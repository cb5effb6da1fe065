"""The lock of a host: one that nobody queues up for, and one around which threads switch."""

import threading
import time
from contextlib import AbstractContextManager
from types import TracebackType

from sim.clock import Clock, VirtualClock

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_RLock = threading.RLock
_sleep = time.sleep

_ASIDE = 50e-6
"""Seconds for which a thread that finds the host's lock taken stands aside."""


class HostLock(type(_RLock())):  # type: ignore[misc]
    """A lock that is never queued up for: whoever finds it taken stands aside and tries again.

    Its holder is then a thread that the interpreter has switched away from in the middle of a few quick
    lines. Threads that queued up for the lock would from then on hand it to each other at every use, each
    time with a switch between threads.
    """

    def __enter__(self) -> bool:
        while not self.acquire(False):
            _sleep(_ASIDE)
        return True


class SwitchedLock:
    """A host's lock on a virtual clock that explores orders: threads switch in front of it and behind it.

    They never switch while one holds it: whoever finds it taken waits outside virtual time. Reentrant.
    """

    def __init__(self, clock: VirtualClock) -> None:
        self._clock = clock
        self._lock = HostLock()

    def __enter__(self) -> bool:
        self._clock.switch_point()
        self._lock.__enter__()
        if self._clock.owns_current_thread():
            self._clock.held_together += 1
        return True

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._clock.owns_current_thread():
            self._clock.held_together -= 1
        self._lock.release()
        self._clock.switch_point()


def lock_on(clock: Clock) -> AbstractContextManager[bool]:
    """The lock of a host with that clock."""
    return SwitchedLock(clock) if isinstance(clock, VirtualClock) and clock.explores else HostLock()
