"""Buffers events until they are sent: bounded, and never blocking."""

from __future__ import annotations

import os
import threading
import time
from collections import deque
from itertools import count
from typing import Any
from weakref import WeakKeyDictionary

_BOUND = 200_000
"""The most events in the buffer; the oldest are dropped, and counted."""
_ROOM = 30
"""The bits of an id below the process id, which makes ids unique on the machine."""

now = time.monotonic_ns


class Here:
    """The state of one thread."""

    __slots__ = ("blocks", "entity", "executor", "sent", "spinner", "spins_in", "thread")

    def __init__(self) -> None:
        self.thread = 0
        self.entity = 0
        """The entity whose callback runs, 0 for none."""
        self.executor = 0
        """The executor whose worker the thread is, 0 for one of the program's own threads."""
        self.spinner: Any = None
        """The state of the executor that the thread spins or works for."""
        self.spins_in = -1
        """The entity in whose callback the thread called a spinning function, 0 for none; -1: in no such."""
        self.sent = 0
        """When the request that the thread has taken was sent, in nanoseconds since 1970; 0: not known."""
        self.blocks = 0
        """The service call for whose reply the thread blocks; -1: ``call()`` has begun, 0: none."""


class _Local(threading.local):
    def __init__(self) -> None:
        self.here = Here()


class Recorder:
    """Gives out ids, and buffers events: tuples of a tag and the fields of that kind. Thread-safe."""

    def __init__(self) -> None:
        self.local = _Local()
        self.lost = 0
        self.idents: dict[int, int] = {}
        """Python's identifiers of the threads that have appeared, by their ids."""
        self.suspended: Any = WeakKeyDictionary()
        """The entities whose callbacks are suspended, or were when they ended, by their coroutines."""
        self._events: deque[tuple[Any, ...]] = deque(maxlen=_BOUND)
        self._ids = count((os.getpid() << _ROOM) + 1)

    @property
    def here(self) -> Here:
        """The state of the calling thread; hot paths read ``local`` instead."""
        return self.local.here

    def new_id(self) -> int:
        """A new id, unique on the machine."""
        return next(self._ids)

    def put(self, *event: Any) -> None:
        """Buffer an event: its tag, its time in nanoseconds of the monotonic clock, and its other fields."""
        if len(self._events) == _BOUND:
            self.lost += 1
        self._events.append(event)

    def take(self) -> list[tuple[Any, ...]]:
        """Remove and return all buffered events, in order."""
        events = []
        while self._events:
            events.append(self._events.popleft())
        return events

    def thread(self) -> int:
        """The id of the calling thread, which is recorded at the first use."""
        here = self.local.here
        if here.thread == 0:
            here.thread = self.new_id()
            self.idents[here.thread] = threading.get_ident()
            self.put("thread", now(), here.thread, threading.current_thread().name, 0, here.executor)
        return here.thread
