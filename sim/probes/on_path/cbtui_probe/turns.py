"""Lets the probe's thread have the interpreter's lock where a busy executor would keep it."""

from __future__ import annotations

import sys
import threading

from .recorder import now

_LATE = 100_000
"""Nanoseconds by which the probe's thread is late before an executor stops for it."""
_LONGEST = 0.002
"""Seconds for which an executor stops at most."""


class Turns:
    """When the probe's thread is to work next. Thread-safe.

    An executor lets go of the lock for some microseconds at each call into rcl. A thread that waits for the
    lock is woken each time, and comes too late: for up to 100 ms, in which each call costs a wake-up.
    """

    def __init__(self) -> None:
        self.late_at = sys.maxsize
        """When the thread is late, in nanoseconds of the monotonic clock."""
        self._stopped: threading.Lock | None = None

    def end(self, seconds: float) -> None:
        """The thread has worked, and will again in so many seconds."""
        self.late_at = now() + int(seconds * 1e9) + _LATE
        stopped, self._stopped = self._stopped, None
        if stopped is not None:
            stopped.release()

    def let(self) -> None:
        """Let the thread work, which is late, before the calling thread goes on."""
        stopped = threading.Lock()
        stopped.acquire()
        self._stopped = stopped
        self.late_at = sys.maxsize
        stopped.acquire(timeout=_LONGEST)
