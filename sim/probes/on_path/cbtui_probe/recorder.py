"""Keeps what happens in this process as events until they are sent: bounded, and never blocking."""

from __future__ import annotations

import os
import threading
import time
from collections import deque
from itertools import count
from typing import Any

_BOUND = 200_000
"""Events that are kept; the oldest are given up, and counted."""
_ROOM = 30
"""Bits for the ids of one process, so that those of several processes differ."""

now = time.monotonic_ns


class Here:
    """What runs on one thread."""

    __slots__ = ("blocks", "entity", "executor", "sent", "spinner", "thread")

    def __init__(self) -> None:
        self.thread = 0
        self.entity = 0
        """The entity whose callback runs, 0 for none."""
        self.executor = 0
        """The executor whose worker the thread is, 0 for a thread of the program's own."""
        self.spinner: Any = None
        """What is known of the executor that the thread spins or works for."""
        self.sent = 0
        """When the request was sent that the thread has taken, in nanoseconds since 1970; 0: not known."""
        self.blocks = 0
        """The service call that the thread waits for; -1: the one that it is about to make, 0: none."""


class _Local(threading.local):
    def __init__(self) -> None:
        self.here = Here()


class Recorder:
    """Gives out ids and takes events, as arrays of a kind's tag and its fields. Thread-safe."""

    def __init__(self) -> None:
        self.local = _Local()
        self.lost = 0
        self.idents: dict[int, int] = {}
        """Python's identifiers of the threads that have appeared, by their ids."""
        self._events: deque[tuple[Any, ...]] = deque(maxlen=_BOUND)
        self._ids = count((os.getpid() << _ROOM) + 1)

    @property
    def here(self) -> Here:
        """What runs on the calling thread; code that cannot afford a call reads ``local``."""
        return self.local.here

    def new_id(self) -> int:
        """An id that nothing else has."""
        return next(self._ids)

    def put(self, *event: Any) -> None:
        """Take an event: its tag, its time in nanoseconds of the monotonic clock, and its other fields."""
        if len(self._events) == _BOUND:
            self.lost += 1
        self._events.append(event)

    def take(self) -> list[tuple[Any, ...]]:
        """Take all events out, in order."""
        events = []
        while self._events:
            events.append(self._events.popleft())
        return events

    def thread(self) -> int:
        """The id of the calling thread, which appears when it is first asked for."""
        here = self.local.here
        if here.thread == 0:
            here.thread = self.new_id()
            self.idents[here.thread] = threading.get_ident()
            self.put("thread", now(), here.thread, threading.current_thread().name, 0, here.executor)
        return here.thread
