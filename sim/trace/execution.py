"""Which callbacks ran when and on which thread, and which were suspended."""

from array import array
from bisect import bisect_left, bisect_right, insort
from collections import defaultdict, deque
from collections.abc import Iterator, Sequence

from sim.trace.events import (
    CallbackEnded,
    CallbackFailed,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    EntityId,
    GroupId,
    MessageId,
    ThreadId,
)
from sim.trace.intervals import Answer, Intervals, Lane, Row
from sim.trace.model import Nanoseconds, Span, Window


class Spans(Intervals):
    """The columns of all spans; ``Span`` objects are made for answers."""

    def __init__(self) -> None:
        super().__init__()
        self.entities = array("i")
        self.threads = array("i")
        self.messages = array("q")
        self.ages = array("q")
        self.errors: dict[Row, str] = {}

    def begin(
        self, at: Nanoseconds, entity: EntityId, thread: ThreadId, message: MessageId, age: Nanoseconds
    ) -> Row:
        """Begin a span."""
        self.entities.append(entity)
        self.threads.append(thread)
        self.messages.append(message)
        self.ages.append(age)
        return self.open(at)

    def span(self, row: Row) -> Span:
        """One span, as a value."""
        return Span(
            self.starts[row],
            self.end(row),
            self.entities[row],
            self.threads[row],
            self.messages[row],
            self.ages[row],
            self.errors.get(row, ""),
        )


class ThreadLane(Lane):
    """The spans of a thread. As they only overlap by nesting, the first layer is all the time it ran any."""

    __slots__ = ("_busy_before", "stack")

    def __init__(self, intervals: Intervals) -> None:
        super().__init__(intervals)
        self.stack: list[Row] = []
        self._busy_before = array("q")

    def add(self, row: Row) -> None:
        """Take in a span that begins inside those of the stack, or after all."""
        super().add(row)
        self.stack.append(row)
        outer = self.layers[0]
        if outer[-1] == row:
            self._busy_before.append(self._ran(outer[-2], len(outer) - 2) if len(outer) > 1 else 0)

    def busy_until(self, at: Nanoseconds) -> Nanoseconds:
        """How long the thread ran callbacks up to ``at``."""
        if not self.layers:
            return 0
        outer = self.layers[0]
        place = bisect_right(outer, at, key=self._intervals.starts.__getitem__) - 1
        if place < 0:
            return 0
        start, end = self._intervals.starts[outer[place]], self._intervals.ends[outer[place]]
        return self._busy_before[place] + min(end, at) - start

    def _ran(self, row: Row, place: int) -> Nanoseconds:
        return self._busy_before[place] + self._intervals.ends[row] - self._intervals.starts[row]


class Execution:
    """Every call of a callback: on its thread, of its entity, in its group.

    A coroutine callback that is suspended leaves its thread and keeps its group: its call is several spans
    with gaps between them. Events do not tell apart simultaneous suspended calls of one entity; the one
    suspended first is taken to be the one that goes on.
    """

    def __init__(self) -> None:
        self._spans = Spans()
        self._gaps = Intervals()
        self._threads: defaultdict[ThreadId, ThreadLane] = defaultdict(lambda: ThreadLane(self._spans))
        self._entities: defaultdict[EntityId, Lane] = defaultdict(lambda: Lane(self._spans))
        self._groups: defaultdict[GroupId, Lane] = defaultdict(lambda: Lane(self._spans))
        self._group_of: dict[EntityId, Lane] = {}
        self._suspended: defaultdict[EntityId, Lane] = defaultdict(lambda: Lane(self._gaps))
        self._awaiting: defaultdict[EntityId, deque[tuple[Row, Row]]] = defaultdict(deque)
        self._resumed_at: defaultdict[EntityId, array[int]] = defaultdict(lambda: array("q"))
        self._resumed: set[Row] = set()
        self._doubtful = 0

    # folding

    def join(self, entity: EntityId, group: GroupId) -> None:
        """From now on the entity's calls count as its group's, and those it has had already."""
        self._group_of[entity] = self._groups[group]
        for row in sorted(row for layer in self._entities[entity].layers for row in layer):
            self._groups[group].add(row)

    def start(self, event: CallbackStarted) -> None:
        """A callback begins."""
        self._begin(event.t, event.entity, event.thread, event.message, event.age)

    def finish(self, event: CallbackEnded) -> None:
        """A callback ends; one that is suspended can end without being resumed."""
        row = self._leave(event.entity, event.thread)
        if row is not None:
            self._spans.close(row, event.t)
        elif self._awaiting[event.entity]:
            gap, _ = self._awaiting[event.entity].popleft()
            self._gaps.close(gap, event.t)

    def suspend(self, event: CallbackSuspended) -> None:
        """A coroutine callback leaves its thread."""
        row = self._leave(event.entity, event.thread)
        if row is None:
            return
        self._spans.close(row, event.t)
        gap = self._gaps.open(event.t)
        self._suspended[event.entity].add(gap)
        self._awaiting[event.entity].append((gap, row))

    def resume(self, event: CallbackResumed) -> None:
        """A coroutine callback goes on; its message and age stay what they were."""
        message = age = 0
        if self._awaiting[event.entity]:
            gap, row = self._awaiting[event.entity].popleft()
            self._gaps.close(gap, event.t)
            message, age = self._spans.messages[row], self._spans.ages[row]
        insort(self._resumed_at[event.entity], event.t)
        self._resumed.add(len(self._spans))
        self._begin(event.t, event.entity, event.thread, message, age)

    def fail(self, event: CallbackFailed) -> None:
        """A callback that runs has raised."""
        for row in reversed(self._threads[event.thread].stack):
            if self._spans.entities[row] == event.entity:
                self._spans.errors[row] = event.error
                return

    def doubt(self) -> None:
        """Events were lost: what runs now may have ended, and has when its thread begins another call."""
        self._doubtful = len(self._spans)

    # answers

    def on(self, thread: ThreadId, window: Window) -> Sequence[Span]:
        """Spans of a thread."""
        return self._made(self._threads[thread], window)

    def of(self, entity: EntityId, window: Window) -> Sequence[Span]:
        """Spans of an entity."""
        return self._made(self._entities[entity], window)

    def begun(self, entity: EntityId, window: Window) -> Sequence[Span]:
        """The spans of an entity with which its calls begin."""
        rows = self._entities[entity].overlapping(window)
        starts = self._spans.starts
        first = [row for row in rows if starts[row] >= window.start and row not in self._resumed]
        return Answer(first, self._spans.span)

    def inside(self, group: GroupId, window: Window) -> Sequence[Span]:
        """Spans of a group."""
        return self._made(self._groups[group], window)

    def innermost(self, thread: ThreadId, at: Nanoseconds) -> Span | None:
        """What a thread runs at ``at``: of nested calls the innermost."""
        rows = self._threads[thread].covering(at)
        return self._spans.span(rows[-1]) if rows else None

    def holds(self, entity: EntityId, at: Nanoseconds) -> bool:
        """Whether the entity's callback runs or is suspended at ``at``."""
        return bool(self._entities[entity].covering(at) or self._suspended[entity].covering(at))

    def busy(self, thread: ThreadId, window: Window) -> Nanoseconds:
        """How long the thread ran callbacks in the window."""
        lane = self._threads[thread]
        return max(0, lane.busy_until(window.end) - lane.busy_until(window.start))

    def calls(self, entity: EntityId, window: Window) -> int:
        """How many calls of the entity's callback begin in the window."""
        resumed = self._resumed_at[entity]
        again = bisect_left(resumed, window.end) - bisect_left(resumed, window.start)
        return max(0, self._entities[entity].starting_in(window) - max(0, again))

    def beside(self, entity: EntityId, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """Times at which spans of the entity begin or end, with the nearest after or before ``at``."""
        yield from self._entities[entity].starts_beside(at, step)
        yield from self._entities[entity].ends_beside(at, step)

    def taken_lately(self, message: MessageId) -> Nanoseconds | None:
        """When one of the last calls took a message."""
        lately = self._spans.messages[-64:]
        if message not in lately:
            return None
        return self._spans.starts[len(self._spans) - len(lately) + lately.index(message)]

    def _begin(
        self, at: Nanoseconds, entity: EntityId, thread: ThreadId, message: MessageId, age: Nanoseconds
    ) -> None:
        lane = self._threads[thread]
        while lane.stack and lane.stack[-1] < self._doubtful:
            self._spans.close(lane.stack.pop(), at)
        row = self._spans.begin(at, entity, thread, message, age)
        lane.add(row)
        self._entities[entity].add(row)
        if entity in self._group_of:
            self._group_of[entity].add(row)

    def _leave(self, entity: EntityId, thread: ThreadId) -> Row | None:
        """Take the innermost call of the entity off the thread."""
        stack = self._threads[thread].stack
        for place in range(len(stack) - 1, -1, -1):
            if self._spans.entities[stack[place]] == entity:
                return stack.pop(place)
        return None

    def _made(self, lane: Lane, window: Window) -> Sequence[Span]:
        return Answer(lane.overlapping(window), self._spans.span)
