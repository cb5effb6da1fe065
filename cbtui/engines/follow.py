"""Follows one run to its end on the caller's thread."""

import math
from collections.abc import Iterator
from contextlib import suppress
from queue import Empty, Full, Queue
from threading import Event
from time import monotonic
from typing import TYPE_CHECKING, Self, TypeAlias

if TYPE_CHECKING:
    from cbtui.engines.session import OpenSession
    from sim.engine.setup import RunSetup
    from sim.trace.events import AnyEvent

    _News: TypeAlias = list[AnyEvent] | str | None

_BATCHES = 64
"""Size of the queue in batches; a full queue blocks the engine, and nothing is lost."""
_POLL = 0.1
"""Real seconds between two checks whether the run was given up."""


class EngineLostError(Exception):
    """The engine ended before its run did; the text says how."""


class RunTimeoutError(Exception):
    """The run did not end within its limit."""


class GivenUpError(Exception):
    """The run was given up by its user."""


class FollowedRun:
    """A run and its engine: iterating yields batches of events; leaving the context ends the engine.

    Used on one thread; ``given_up`` may be set from any. Without a ``limit`` it waits for ever.
    """

    def __init__(self, setup: "RunSetup", open_session: "OpenSession", given_up: Event | None = None) -> None:
        self._queue: Queue[_News] = Queue(_BATCHES)
        self._left = Event()
        self._given_up = given_up or Event()
        self._deadline = math.inf
        self.session = open_session(setup, self._put, self._put)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._left.set()
        self.session.stop()

    def start(self) -> str | None:
        """Start the engine; returns a sentence if not all of it works.

        Raises:
            GivenUpError: the run was given up before it began.
            OSError: the engine could not be started.
        """
        self._check_wanted()
        return self.session.start()

    def limit(self, seconds: float) -> None:
        """Set the timeout, in real seconds from now, replacing an earlier one."""
        self._deadline = monotonic() + seconds

    def __iter__(self) -> Iterator[list["AnyEvent"]]:
        """Iterate over ``next_batch``."""
        return iter(self.next_batch, None)

    def next_batch(self) -> list["AnyEvent"] | None:
        """Wait for the next events; None after the normal end of the run.

        Raises:
            EngineLostError: the engine ended before the run did.
            RunTimeoutError: the limit has passed.
            GivenUpError: ``given_up`` was set.
        """
        news = self._next()
        if isinstance(news, str):
            raise EngineLostError(news)
        return news

    def _next(self) -> "_News":
        while (left := self._deadline - monotonic()) > 0:
            self._check_wanted()
            with suppress(Empty):
                return self._queue.get(timeout=min(left, _POLL))
        raise RunTimeoutError

    def _check_wanted(self) -> None:
        if self._given_up.is_set():
            raise GivenUpError

    def _put(self, news: "_News") -> None:
        """Put a batch into the queue; called on the session's reader thread."""
        while not self._left.is_set():
            with suppress(Full):
                self._queue.put(news, timeout=_POLL)
                return
