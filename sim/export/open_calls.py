"""Tracks the open calls of each thread, event by event."""

from collections import defaultdict, deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from sim.trace.events import (
    CallbackEnded,
    CallbackFailed,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    EntityId,
    MessageId,
    ThreadId,
)
from sim.trace.model import Nanoseconds


@dataclass(slots=True, eq=False)
class CallSegment:
    """A call of a callback on a thread, or the part of it between two suspensions.

    ``wait`` is how long the callback, or its message, had waited when the call began; 0 after a suspension.
    ``lane`` is the call's lane in its group, the same for all its segments.
    """

    number: int
    start: Nanoseconds
    entity: EntityId
    thread: ThreadId
    message: MessageId
    age: Nanoseconds
    wait: Nanoseconds = 0
    lane: int = 0
    error: str = ""


class OpenCalls:
    """The calls that have started and not ended.

    Events do not distinguish suspended calls of one entity: the one suspended first is taken to resume first.
    Not thread-safe.
    """

    def __init__(self) -> None:
        self._stacks: defaultdict[ThreadId, list[CallSegment]] = defaultdict(list)
        self._suspended: defaultdict[EntityId, deque[CallSegment]] = defaultdict(deque)
        self._begun = 0
        self._uncertain_below = 0

    def ended_unseen(self, thread: ThreadId) -> Iterator[CallSegment]:
        """Remove the calls whose ends were lost and which must be over, as their thread starts another."""
        stack = self._stacks[thread]
        while stack and stack[-1].number < self._uncertain_below:
            yield stack.pop()

    def start(self, event: CallbackStarted, wait: Nanoseconds) -> CallSegment:
        """Start a call."""
        return self._push(
            CallSegment(self._begun, event.t, event.entity, event.thread, event.message, event.age, wait)
        )

    def resume(self, event: CallbackResumed) -> tuple[CallSegment, CallSegment | None]:
        """Resume a suspended call; return its new segment and, if known, the one before."""
        suspended = self._suspended[event.entity]
        if not suspended:
            return self._push(CallSegment(self._begun, event.t, event.entity, event.thread, 0, 0)), None
        old = suspended.popleft()
        new = CallSegment(
            self._begun, event.t, old.entity, event.thread, old.message, old.age, 0, old.lane, old.error
        )
        return self._push(new), old

    def suspend(self, event: CallbackSuspended) -> Sequence[CallSegment]:
        """Suspend a call; return its segment, last, behind nested ones whose end events were lost."""
        left = self._leave(event.entity, event.thread)
        if left:
            self._suspended[event.entity].append(left[-1])
        return left

    def finish(self, event: CallbackEnded) -> Sequence[CallSegment]:
        """End a call; return its segment, last, behind nested ones whose end events were lost."""
        return self._leave(event.entity, event.thread)

    def finish_suspended(self, entity: EntityId) -> CallSegment | None:
        """End a suspended call of the entity that was not resumed; return its last segment."""
        suspended = self._suspended[entity]
        return suspended.popleft() if suspended else None

    def fail(self, event: CallbackFailed) -> None:
        """Set the error of a call that raised."""
        for segment in reversed(self._stacks[event.thread]):
            if segment.entity == event.entity:
                segment.error = event.error
                return

    def mark_uncertain(self) -> None:
        """Note that events were lost: the open calls may have ended unseen."""
        self._uncertain_below = self._begun

    def thread_of(self, entity: EntityId) -> ThreadId | None:
        """The thread of the entity's latest running call."""
        latest: CallSegment | None = None
        for stack in self._stacks.values():
            for segment in stack:
                if segment.entity == entity and (latest is None or segment.number > latest.number):
                    latest = segment
        return None if latest is None else latest.thread

    def running(self) -> Iterator[CallSegment]:
        """The segments that are running, on each thread the innermost first."""
        for stack in self._stacks.values():
            yield from reversed(stack)

    def suspended(self) -> Iterator[CallSegment]:
        """The last segments of the suspended calls."""
        for suspended in self._suspended.values():
            yield from suspended

    def _push(self, segment: CallSegment) -> CallSegment:
        self._begun += 1
        self._stacks[segment.thread].append(segment)
        return segment

    def _leave(self, entity: EntityId, thread: ThreadId) -> Sequence[CallSegment]:
        stack = self._stacks[thread]
        for place in range(len(stack) - 1, -1, -1):
            if stack[place].entity == entity:
                left = stack[place:]
                del stack[place:]
                left.reverse()
                return left
        return ()
