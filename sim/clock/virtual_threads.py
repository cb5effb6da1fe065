"""Threads that live on virtual time, and the signals between them."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.clock.lock_cycles import HeldResource
    from sim.clock.virtual import VirtualClock

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_allocate_lock = threading.Lock


class VirtualThread:
    """A thread on virtual time: it runs while it has the baton, and waits at its gate otherwise."""

    __slots__ = (
        "current_wait",
        "gate",
        "ident",
        "interrupted",
        "is_main",
        "name",
        "stays",
        "waiting",
        "wants",
        "woken",
    )

    def __init__(self, name: str) -> None:
        self.name = name
        self.is_main = False
        self.ident = 0
        self.stays = False
        """Whether switch points are disabled for it."""
        self.interrupted = False
        self.gate = _allocate_lock()
        self.gate.acquire()
        self.waiting = False
        self.wants: HeldResource | None = None
        """What it waits for without a timeout: a lock, or the end of a thread."""
        self.woken = False
        self.current_wait = 0


class VirtualAutoResetEvent:
    """A signal between threads on virtual time; others may set it through ``VirtualTime.inject``."""

    __slots__ = ("_clock", "_set", "_waiter")

    def __init__(self, clock: VirtualClock) -> None:
        self._clock = clock
        self._set = False
        self._waiter: VirtualThread | None = None

    def wait(self, deadline: int | None) -> bool:
        """Wait until set, or until virtual time reaches ``deadline``; True if it was set."""
        if deadline is not None and deadline <= self._clock.now():
            self._clock.poll()
        while not self._set and (deadline is None or deadline > self._clock.now()):
            self._waiter = self._clock.current
            try:
                if not self._clock.park(deadline):
                    break
            finally:
                self._waiter = None
        was_set, self._set = self._set, False
        return was_set

    def set(self) -> None:
        """Set the flag; the waiting thread becomes able to run."""
        self._set = True
        if self._waiter is not None:
            self._clock.unpark(self._waiter)
