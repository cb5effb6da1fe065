"""Starts a thread without waiting in virtual time for the moment at which it has started."""

import threading
from typing import Any

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_allocate_lock = threading.Lock
_start_thread = threading.Thread.start


class _Started:
    """Replaces a thread's own "has started" event, which is set before the thread is on the clock."""

    def __init__(self) -> None:
        self._gate = _allocate_lock()
        self._gate.acquire()

    def set(self) -> None:
        self._gate.release()

    def is_set(self) -> bool:
        return not self._gate.locked()

    def wait(self, timeout: float = -1) -> bool:
        in_time = self._gate.acquire(timeout=timeout)
        if in_time:
            self._gate.release()
        return in_time


def start_outside(thread: threading.Thread) -> None:
    """Start a thread without waiting in virtual time for the moment at which it has started."""
    inner: Any = thread
    inner._started = _Started()
    _start_thread(thread)
