"""What waits in the queue of an entity, and what was lost there, as step functions of time."""

from array import array
from bisect import bisect_left, bisect_right, insort
from collections.abc import Callable

from sim.trace.events import MessageId
from sim.trace.model import Nanoseconds, Queue, Window


class QueueHistory:
    """Depth, arrivals and losses of one queue.

    A queue is first in, first out and loses its oldest: at depth d it holds the d newest arrivals.
    """

    __slots__ = ("_arrived_at", "_arrived_messages", "_depths", "_lost_at", "_steps_at")

    def __init__(self) -> None:
        self._steps_at = array("q")
        self._depths = array("i")
        self._arrived_at = array("q")
        self._arrived_messages = array("q")
        self._lost_at = array("q")

    def arrive(self, at: Nanoseconds, depth: int, message: MessageId) -> None:
        """Something came, ``depth`` are there now."""
        self.become(at, depth)
        place = place_of(self._arrived_at, at)
        self._arrived_at.insert(place, at)
        self._arrived_messages.insert(place, message)

    def lose(self, at: Nanoseconds, depth: int) -> None:
        """The oldest was lost, ``depth`` are there now."""
        self.become(at, depth)
        insort(self._lost_at, at)

    def become(self, at: Nanoseconds, depth: int) -> None:
        """From ``at`` on ``depth`` are there."""
        place = place_of(self._steps_at, at)
        self._steps_at.insert(place, at)
        self._depths.insert(place, depth)

    def queue(self, at: Nanoseconds, born: Callable[[MessageId], Nanoseconds | None]) -> Queue:
        """The queue after all that happens at ``at``; ``born`` tells when a message was published."""
        place = bisect_right(self._steps_at, at)
        depth = self._depths[place - 1] if place else 0
        return Queue(depth, bisect_right(self._lost_at, at), self._oldest(at, depth, born))

    def lost_in(self, window: Window) -> int:
        """How many messages were lost in the window."""
        return max(0, bisect_left(self._lost_at, window.end) - bisect_left(self._lost_at, window.start))

    def loss_beside(self, at: Nanoseconds, step: int) -> Nanoseconds | None:
        """The first loss after ``at`` (``step`` > 0), or the last one before it."""
        place = bisect_right(self._lost_at, at) if step > 0 else bisect_left(self._lost_at, at) - 1
        return self._lost_at[place] if 0 <= place < len(self._lost_at) else None

    def _oldest(
        self, at: Nanoseconds, depth: int, born: Callable[[MessageId], Nanoseconds | None]
    ) -> Nanoseconds | None:
        arrived = bisect_right(self._arrived_at, at)
        if depth <= 0 or arrived == 0:
            return None
        place = max(0, arrived - depth)
        published = born(self._arrived_messages[place])
        return self._arrived_at[place] if published is None else published


def place_of(times: "array[int]", at: Nanoseconds) -> int:
    """Where ``at`` belongs in ascending times, after its equals: nearly always the end."""
    if not times or times[-1] <= at:
        return len(times)
    return bisect_right(times, at)
