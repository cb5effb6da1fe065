"""The calls in progress on each thread, followed event by event."""

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
class Stretch:
    """A call of a callback on a thread, or what of it lies between two suspensions.

    ``wait`` is how long the callback had been ready when the call began; 0 after a suspension. ``lane``
    keeps the call's place in its group, and stays what it is through suspensions.
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


class Running:
    """The calls that have begun and not ended.

    Suspended calls of one entity go on in the order in which they were suspended, as events do not tell them
    apart. Not thread-safe.
    """

    def __init__(self) -> None:
        self._stacks: defaultdict[ThreadId, list[Stretch]] = defaultdict(list)
        self._suspended: defaultdict[EntityId, deque[Stretch]] = defaultdict(deque)
        self._begun = 0
        self._doubtful = 0

    def outdated(self, thread: ThreadId) -> Iterator[Stretch]:
        """Take off the thread what must have ended, before it begins a call: its end was lost."""
        stack = self._stacks[thread]
        while stack and stack[-1].number < self._doubtful:
            yield stack.pop()

    def start(self, event: CallbackStarted, wait: Nanoseconds) -> Stretch:
        """A call begins."""
        return self._push(
            Stretch(self._begun, event.t, event.entity, event.thread, event.message, event.age, wait)
        )

    def resume(self, event: CallbackResumed) -> tuple[Stretch, Stretch | None]:
        """A suspended call goes on: its new stretch and the one before, if that is known."""
        suspended = self._suspended[event.entity]
        if not suspended:
            return self._push(Stretch(self._begun, event.t, event.entity, event.thread, 0, 0)), None
        old = suspended.popleft()
        new = Stretch(
            self._begun, event.t, old.entity, event.thread, old.message, old.age, 0, old.lane, old.error
        )
        return self._push(new), old

    def suspend(self, event: CallbackSuspended) -> Sequence[Stretch]:
        """A call leaves its thread: it, after those begun inside it whose end was lost."""
        left = self._leave(event.entity, event.thread)
        if left:
            self._suspended[event.entity].append(left[-1])
        return left

    def finish(self, event: CallbackEnded) -> Sequence[Stretch]:
        """A call ends: it, after those begun inside it whose end was lost; none if it was not running."""
        return self._leave(event.entity, event.thread)

    def finish_suspended(self, entity: EntityId) -> Stretch | None:
        """A suspended call of the entity ends without going on: its last stretch."""
        suspended = self._suspended[entity]
        return suspended.popleft() if suspended else None

    def fail(self, event: CallbackFailed) -> None:
        """A call has raised."""
        for stretch in reversed(self._stacks[event.thread]):
            if stretch.entity == event.entity:
                stretch.error = event.error
                return

    def doubt(self) -> None:
        """Events were lost: what runs now may have ended."""
        self._doubtful = self._begun

    def thread_of(self, entity: EntityId) -> ThreadId | None:
        """The thread on which the entity's latest call runs."""
        latest: Stretch | None = None
        for stack in self._stacks.values():
            for stretch in stack:
                if stretch.entity == entity and (latest is None or stretch.number > latest.number):
                    latest = stretch
        return None if latest is None else latest.thread

    def left_over(self) -> Iterator[Stretch]:
        """What runs at the end of the stream, on each thread the innermost first."""
        for stack in self._stacks.values():
            yield from reversed(stack)

    def left_suspended(self) -> Iterator[Stretch]:
        """What is suspended at the end of the stream."""
        for suspended in self._suspended.values():
            yield from suspended

    def _push(self, stretch: Stretch) -> Stretch:
        self._begun += 1
        self._stacks[stretch.thread].append(stretch)
        return stretch

    def _leave(self, entity: EntityId, thread: ThreadId) -> Sequence[Stretch]:
        stack = self._stacks[thread]
        for place in range(len(stack) - 1, -1, -1):
            if stack[place].entity == entity:
                left = stack[place:]
                del stack[place:]
                left.reverse()
                return left
        return ()
