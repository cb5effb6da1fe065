"""The contents and losses of an entity's queue as functions of time."""

from collections import deque
from collections.abc import Callable, Sequence
from typing import TypeAlias

from sim.trace.events import MessageId
from sim.trace.lazy import LazySequence
from sim.trace.model import Nanoseconds, Queue, QueuedMessage, Window
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import IntegerTable

OriginTime: TypeAlias = Callable[[MessageId], Nanoseconds | None]
"""Returns when a message was published or a request sent; None if that is unknown."""


class QueueHistory:
    """Depth, arrivals and losses of one queue.

    A queue is first in, first out and drops its oldest: at depth d it holds the d newest arrivals. Messages
    that left out of turn are recorded separately: those that expired behind others with a longer lifespan,
    and those that an action took from another of its parts. If an action takes several messages at once, the
    trace has one of them; the others are taken to be the oldest.
    """

    __slots__ = ("_arrived", "_left_early", "_lost_at", "_queued", "_steps")

    def __init__(self, spill: SpillFile) -> None:
        self._steps = IntegerTable(spill, 2)
        self._arrived = IntegerTable(spill, 2)
        self._lost_at = IntegerTable(spill, 1)
        self._queued: deque[MessageId] = deque()
        self._left_early = IntegerTable(spill, 2)

    def arrive(self, at: Nanoseconds, depth: int, message: MessageId) -> None:
        """Add a message; ``depth`` are queued then."""
        self._arrived.add([at, message])
        self._queued.append(message)
        self._set_depth(at, depth)

    def take(self, at: Nanoseconds, depth: int, message: MessageId) -> None:
        """Remove the message that a callback took (0: none); ``depth`` are left."""
        if message:
            self._leave(at, message)
        self._set_depth(at, depth)

    def lose(self, at: Nanoseconds, depth: int, message: MessageId) -> None:
        """Remove a lost message; ``depth`` are left."""
        self._leave(at, message)
        self._set_depth(at, depth)
        self._lost_at.add([at])

    def clear(self, at: Nanoseconds) -> None:
        """Empty the queue, since its entity is gone."""
        self._set_depth(at, 0)

    def queue(self, at: Nanoseconds, origin_time: OriginTime) -> Queue:
        """The queue after all events at ``at``; messages of unknown origin count from their arrival."""
        place = self._steps.until(at)
        depth = self._steps.cell(place - 1, 1) if place else 0
        return Queue(depth, self._lost_at.until(at), self._messages(at, depth, origin_time))

    def losses(self, window: Window) -> Sequence[Nanoseconds]:
        """The times of losses in the window."""
        places = range(self._lost_at.before(window.start), self._lost_at.before(window.end))
        return self._lost_at.column(0, places)

    def lost_in(self, window: Window) -> int:
        """The number of losses in the window."""
        return max(0, self._lost_at.before(window.end) - self._lost_at.before(window.start))

    def loss_beside(self, at: Nanoseconds, step: int) -> Nanoseconds | None:
        """The first loss after ``at`` (``step`` > 0), or the last one before it."""
        place = self._lost_at.until(at) if step > 0 else self._lost_at.before(at) - 1
        return self._lost_at.cell(place, 0) if 0 <= place < len(self._lost_at) else None

    def _set_depth(self, at: Nanoseconds, depth: int) -> None:
        self._steps.add([at, depth])
        while self._queued and len(self._queued) > depth:
            self._queued.popleft()

    def _leave(self, at: Nanoseconds, message: MessageId) -> None:
        if self._queued and self._queued[0] == message:
            self._queued.popleft()
            return
        if message in self._queued:
            self._queued.remove(message)
        self._left_early.add([message, at])

    def _messages(self, at: Nanoseconds, depth: int, origin_time: OriginTime) -> Sequence[QueuedMessage]:
        after = self._arrived.until(at)
        queued = range(self._oldest(depth, after, at), after)
        arrivals, messages = (list(self._arrived.column(column, queued)) for column in (0, 1))

        def message_at(place: int) -> QueuedMessage:
            since, arrived = origin_time(messages[place]), arrivals[place]
            return QueuedMessage(messages[place], arrived if since is None else since, arrived)

        places: Sequence[int] = range(len(messages))
        if len(self._left_early):
            places = [place for place in places if not self._has_left(messages[place], arrivals[place], at)]
        return LazySequence(places, message_at)

    def _oldest(self, depth: int, after: int, at: Nanoseconds) -> int:
        """The place from which on ``depth`` of the arrivals before ``after`` are still queued at ``at``."""
        if not len(self._left_early):
            return max(0, after - depth)
        place = after
        while depth > 0 and place:
            place -= 1
            depth -= not self._has_left(self._arrived.cell(place, 1), self._arrived.cell(place, 0), at)
        return place

    def _has_left(self, message: MessageId, arrived: Nanoseconds, at: Nanoseconds) -> bool:
        place = self._left_early.find(message)
        return place is not None and arrived <= self._left_early.cell(place, 1) <= at
