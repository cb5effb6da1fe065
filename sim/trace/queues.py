"""The contents and losses of an entity's queue as functions of time."""

from collections import deque
from collections.abc import Callable, Sequence
from typing import TypeAlias

from sim.trace.events import MessageId
from sim.trace.model import Nanoseconds, Queue, QueuedMessage, Window
from sim.trace.storage.intervals import LazySequence
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import Table

OriginTime: TypeAlias = Callable[[MessageId], Nanoseconds | None]
"""When a message was published or a request sent; None if that is not known."""


class QueueHistory:
    """Depth, arrivals and losses of one queue.

    A queue is first in, first out and loses its oldest: at depth d it holds the d newest arrivals. All that
    left out of its turn is kept besides: what expired behind messages with more time to live, and what
    an action took from another of its parts. Of several messages that an action takes at once the trace
    tells one; the others are taken to be the oldest.
    """

    __slots__ = ("_arrived", "_left_early", "_lost_at", "_now", "_steps")

    def __init__(self, spill: SpillFile) -> None:
        self._steps = Table(spill, 2)
        self._arrived = Table(spill, 2)
        self._lost_at = Table(spill, 1)
        self._now: deque[MessageId] = deque()
        self._left_early = Table(spill, 2)

    def arrive(self, at: Nanoseconds, depth: int, message: MessageId) -> None:
        """A message arrived; ``depth`` are in the queue now."""
        self._arrived.add([at, message])
        self._now.append(message)
        self._become(at, depth)

    def take(self, at: Nanoseconds, depth: int, message: MessageId) -> None:
        """A callback got a message (0: none), ``depth`` are left."""
        if message:
            self._leave(at, message)
        self._become(at, depth)

    def lose(self, at: Nanoseconds, depth: int, message: MessageId) -> None:
        """A message was lost, ``depth`` are left."""
        self._leave(at, message)
        self._become(at, depth)
        self._lost_at.add([at])

    def clear(self, at: Nanoseconds) -> None:
        """The queue is gone with all that it held."""
        self._become(at, 0)

    def queue(self, at: Nanoseconds, born: OriginTime) -> Queue:
        """The queue after all that happens at ``at``; what arrived without being born counts from then."""
        place = self._steps.until(at)
        depth = self._steps.cell(place - 1, 1) if place else 0
        return Queue(depth, self._lost_at.until(at), self._messages(at, depth, born))

    def losses(self, window: Window) -> Sequence[Nanoseconds]:
        """When messages were lost in the window."""
        places = range(self._lost_at.before(window.start), self._lost_at.before(window.end))
        return self._lost_at.column(0, places)

    def lost_in(self, window: Window) -> int:
        """How many messages were lost in the window."""
        return max(0, self._lost_at.before(window.end) - self._lost_at.before(window.start))

    def loss_beside(self, at: Nanoseconds, step: int) -> Nanoseconds | None:
        """The first loss after ``at`` (``step`` > 0), or the last one before it."""
        place = self._lost_at.until(at) if step > 0 else self._lost_at.before(at) - 1
        return self._lost_at.cell(place, 0) if 0 <= place < len(self._lost_at) else None

    def _become(self, at: Nanoseconds, depth: int) -> None:
        self._steps.add([at, depth])
        while self._now and len(self._now) > depth:
            self._now.popleft()

    def _leave(self, at: Nanoseconds, message: MessageId) -> None:
        if self._now and self._now[0] == message:
            self._now.popleft()
            return
        if message in self._now:
            self._now.remove(message)
        self._left_early.add([message, at])

    def _messages(self, at: Nanoseconds, depth: int, born: OriginTime) -> Sequence[QueuedMessage]:
        after = self._arrived.until(at)
        there = range(self._oldest(depth, after, at), after)
        arrivals, messages = (list(self._arrived.column(column, there)) for column in (0, 1))

        def queued(place: int) -> QueuedMessage:
            since = born(messages[place])
            return QueuedMessage(messages[place], arrivals[place] if since is None else since)

        places: Sequence[int] = range(len(messages))
        if len(self._left_early):
            places = [place for place in places if not self._has_left(messages[place], arrivals[place], at)]
        return LazySequence(places, queued)

    def _oldest(self, depth: int, after: int, at: Nanoseconds) -> int:
        """The place from which on ``depth`` of the arrivals before ``after`` are still there at ``at``."""
        if not len(self._left_early):
            return max(0, after - depth)
        place = after
        while depth > 0 and place:
            place -= 1
            depth -= not self._has_left(self._arrived.cell(place, 1), self._arrived.cell(place, 0), at)
        return place

    def _has_left(self, message: MessageId, arrived: Nanoseconds, at: Nanoseconds) -> bool:
        place = self._left_early.until(message) - 1
        if place < 0 or self._left_early.cell(place, 0) != message:
            return False
        return arrived <= self._left_early.cell(place, 1) <= at
