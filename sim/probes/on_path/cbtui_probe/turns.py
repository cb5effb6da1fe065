"""Hands the GIL over to the probe's thread where a busy executor would keep it."""

from __future__ import annotations

import sys
import threading

from .recorder import now

_LATE = 100_000
"""The lateness of the probe's thread, in nanoseconds, from which an executor waits for it."""
_LONGEST = 0.002
"""The longest time that an executor waits, in seconds."""


class Turns:
    """When the probe's thread is due. Thread-safe.

    An executor releases the GIL for some microseconds at each call into rcl. A thread that waits for the GIL
    is woken each time and comes too late, for up to 100 ms, and each wake-up slows the call.
    """

    def __init__(self) -> None:
        self.late_at = sys.maxsize
        """From when on the thread is late, in nanoseconds of the monotonic clock."""
        self._stopped: threading.Lock | None = None

    def end(self, seconds: float) -> None:
        """Note that the thread has worked, and is due again in so many seconds."""
        self.late_at = now() + int(seconds * 1e9) + _LATE
        stopped, self._stopped = self._stopped, None
        if stopped is not None:
            stopped.release()

    def let(self) -> None:
        """Wait until the late thread has worked."""
        stopped = threading.Lock()
        stopped.acquire()
        self._stopped = stopped
        self.late_at = sys.maxsize
        stopped.acquire(timeout=_LONGEST)
