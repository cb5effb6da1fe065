"""Threads that live on virtual time, and what they wait for."""

from __future__ import annotations

import threading
from types import CodeType
from typing import Protocol

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


class HeldResource(Protocol):
    """A lock, or a thread's end, with its holder."""

    holder: VirtualThread | None
    """The thread of the clock that has it; the one that is to end."""
    guards: bool
    """Whether only its holder can end the wait: it was taken in such a way, or is a thread's end."""
    taken_at: tuple[CodeType, int] | None
    """Where in the program a lock was taken last: the code, and how far in; None for a thread's end."""
