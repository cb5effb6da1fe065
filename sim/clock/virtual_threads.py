"""Threads that live on virtual time, what they wait for, and how a thread is started beside that time."""

import threading
from types import CodeType
from typing import Any, Protocol

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_allocate_lock = threading.Lock
_start_thread = threading.Thread.start


class VirtualThread:
    """A thread on virtual time. It runs while it has the baton, and waits at its gate otherwise."""

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
        """Whether switch points are disabled for this thread."""
        self.interrupted = False
        self.gate = _allocate_lock()
        self.gate.acquire()
        self.waiting = False
        self.wants: HeldResource | None = None
        """What the thread waits for without a timeout: a lock, or the end of another thread."""
        self.woken = False
        self.current_wait = 0


class HeldResource(Protocol):
    """A lock, or a thread's end, with its holder."""

    holder: VirtualThread | None
    """The thread of the clock that has the lock, or that is to end."""
    guards: bool
    """Whether only the holder can end the wait: for a thread's end, and for a lock taken by ``with``."""
    taken_at: tuple[CodeType, int] | None
    """Where the lock was taken last: the code object and the offset; None for the end of a thread."""


class _Started:
    """Replaces a thread's own "has started" event, which Python sets before the thread is on the clock."""

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
    """Start a thread, and wait in real time until it has started: virtual time does not pass."""
    inner: Any = thread
    inner._started = _Started()
    _start_thread(thread)
