"""Which callbacks ran when and on which thread, and which were suspended."""

from collections import defaultdict, deque
from collections.abc import Collection, Iterator, Sequence

from sim.trace.decisions import Decisions
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
from sim.trace.lazy import LazySequence
from sim.trace.model import Deed, Nanoseconds, Span, Window
from sim.trace.storage.intervals import OPEN, IntervalLane, Intervals, Layer, RowId, end_or_none
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import IntegerTable

ALWAYS = Window(-OPEN, OPEN)

LATEST_SEARCHED = 64
"""The number of latest calls that are searched for the one that took a message with a late event."""

_NONE = ("", "", False, ("", 0))
"""The exception of a call that raised none."""


class Spans(Intervals):
    """The table of all spans; ``Span`` objects are made for answers."""

    ENTITY, THREAD, MESSAGE, AGE, FAILURE, FIRST = range(2, 8)

    def __init__(self, spill: SpillFile) -> None:
        super().__init__(spill, more=6)
        self._failures = [_NONE]
        self._failure_of = {_NONE: 0}

    def begin(
        self,
        at: Nanoseconds,
        entity: EntityId,
        thread: ThreadId,
        message: MessageId,
        age: Nanoseconds,
        first: RowId | None,
    ) -> RowId:
        """Begin a span; ``first`` is that with which its call began, None for this one."""
        own = len(self)
        return self.table.append([at, OPEN, entity, thread, message, age, 0, own if first is None else first])

    def entity(self, row: RowId) -> EntityId:
        """The entity of a span."""
        return self.table.cell(row, self.ENTITY)

    def taken(self, row: RowId) -> tuple[MessageId, Nanoseconds]:
        """The message that a span's call took, and its age then."""
        return self.table.cell(row, self.MESSAGE), self.table.cell(row, self.AGE)

    def was_resumed(self, row: RowId) -> bool:
        """Whether the span begins with a resumption."""
        return self.first(row) != row

    def first(self, row: RowId) -> RowId:
        """The span with which the call of a span began, -1 if it is not known."""
        return self.table.cell(row, self.FIRST)

    def fail(self, row: RowId, event: CallbackFailed) -> None:
        """Set the exception of a span."""
        failure = event.error, event.exception, event.no_response, (event.file, event.line)
        if failure not in self._failure_of:
            self._failure_of[failure] = len(self._failures)
            self._failures.append(failure)
        self.table.change(row, self.FAILURE, self._failure_of[failure])

    def span(self, row: RowId) -> Span:
        """One span, as a value."""
        start, end, entity, thread, message, age, failure, first = self.table.row(row)
        failed = self._failures[failure]
        return Span(start, end_or_none(end), entity, thread, message, age, *failed, row, first)


class ThreadSpans(IntervalLane):
    """The spans of a thread. They overlap only by nesting, so the first layer covers all its busy time."""

    __slots__ = ("_busy", "_busy_before", "_latest", "stack")

    def __init__(self, intervals: Intervals) -> None:
        super().__init__(intervals)
        self.stack: list[RowId] = []
        self._latest: RowId | None = None
        self._busy: Nanoseconds = 0
        self._busy_before = IntegerTable(intervals.spill, 1)

    def add(self, row: RowId) -> Layer:
        """Add a span that begins inside those of the stack, or after all; return its layer."""
        layer = super().add(row)
        self.stack.append(row)
        if layer is self.layers[0]:
            if self._latest is not None:
                ended = self._intervals.ended_at(self._latest)
                self._busy += ended - self._intervals.started_at(self._latest)
            self._busy_before.append([self._busy])
            self._latest = row
        return layer

    def busy_until(self, at: Nanoseconds) -> Nanoseconds:
        """How long the thread ran callbacks up to ``at``."""
        if not self.layers:
            return 0
        outer = self.layers[0]
        place = outer.until(at) - 1
        if place < 0:
            return 0
        end = self._intervals.ended_at(outer.interval(place))
        return self._busy_before.cell(place, 0) + min(end, at) - outer.start(place)


class Execution:
    """Every call of a callback: on its thread, of its entity, in its group.

    A suspended coroutine callback leaves its thread and keeps its group: its call is several spans with gaps
    between them. Events do not distinguish suspended calls of one entity: the one suspended first is taken to
    resume first.
    """

    def __init__(self, spill: SpillFile, decisions: Decisions) -> None:
        self._decisions = decisions
        self._spans = Spans(spill)
        self._gaps = Intervals(spill)
        self._threads: defaultdict[ThreadId, ThreadSpans] = defaultdict(lambda: ThreadSpans(self._spans))
        self._entities: defaultdict[EntityId, IntervalLane] = defaultdict(lambda: IntervalLane(self._spans))
        self._groups: defaultdict[GroupId, IntervalLane] = defaultdict(lambda: IntervalLane(self._spans))
        self._group_of: dict[EntityId, IntervalLane] = {}
        self._suspended: defaultdict[EntityId, IntervalLane] = defaultdict(lambda: IntervalLane(self._gaps))
        self._awaiting: defaultdict[EntityId, deque[tuple[RowId, RowId]]] = defaultdict(deque)
        self._resumed_at: defaultdict[EntityId, IntegerTable] = defaultdict(lambda: IntegerTable(spill, 1))
        self._uncertain_below = 0
        self._newest_taken: MessageId = -1

    # events

    def join(self, entity: EntityId, group: GroupId) -> None:
        """Count the entity's calls, past and future, as its group's."""
        self._group_of[entity] = self._groups[group]
        for row in sorted(self._entities[entity].overlapping(ALWAYS)):
            self._groups[group].add(row)

    def start(self, event: CallbackStarted) -> None:
        """Start a call."""
        row = self._begin(event.t, event.entity, event.thread, event.message, event.age)
        self._decisions.add(event.t, Deed.BEGUN, row)

    def finish(self, event: CallbackEnded) -> bool:
        """End a call; return whether it was suspended, and ends without being resumed."""
        row = self._leave(event.entity, event.thread)
        if row is not None:
            self._spans.close(row, event.t)
            self._decisions.add(event.t, Deed.ENDED, row)
        elif self._awaiting[event.entity]:
            gap, _ = self._awaiting[event.entity].popleft()
            self._gaps.close(gap, event.t)
            return True
        return False

    def suspend(self, event: CallbackSuspended) -> None:
        """Suspend a coroutine's call."""
        row = self._leave(event.entity, event.thread)
        if row is None:
            return
        self._spans.close(row, event.t)
        self._decisions.add(event.t, Deed.SUSPENDED, row)
        gap = self._gaps.open(event.t)
        self._suspended[event.entity].add(gap)
        self._awaiting[event.entity].append((gap, row))

    def resume(self, event: CallbackResumed) -> None:
        """Resume a coroutine's call, with its message and age."""
        message = age = 0
        first = -1
        if self._awaiting[event.entity]:
            gap, row = self._awaiting[event.entity].popleft()
            self._gaps.close(gap, event.t)
            message, age = self._spans.taken(row)
            first = self._spans.first(row)
        self._resumed_at[event.entity].add([event.t])
        row = self._begin(event.t, event.entity, event.thread, message, age, first)
        self._decisions.add(event.t, Deed.RESUMED, row)

    def fail(self, event: CallbackFailed) -> None:
        """Set the error of the running call."""
        for row in reversed(self._threads[event.thread].stack):
            if self._spans.entity(row) == event.entity:
                self._spans.fail(row, event)
                return

    def mark_uncertain(self) -> None:
        """Note that events were lost: a running call is over when its thread starts another."""
        self._uncertain_below = len(self._spans)

    # queries

    @property
    def is_running(self) -> bool:
        """Whether a callback runs on any thread after the last event."""
        return any(thread.stack for thread in self._threads.values())

    def has_nested(self, thread: ThreadId) -> bool:
        """Whether a span on a thread ever began inside another one."""
        return len(self._threads[thread].layers) > 1

    def on(self, thread: ThreadId, window: Window) -> Sequence[Span]:
        """Spans of a thread."""
        return self._made(self._threads[thread], window)

    def of(self, entity: EntityId, window: Window) -> Sequence[Span]:
        """Spans of an entity."""
        return self._made(self._entities[entity], window)

    def begun(self, entity: EntityId, window: Window) -> Sequence[Span]:
        """The spans of an entity with which its calls begin."""
        rows = self._entities[entity].starting(window)
        if self._resumed_at[entity]:
            rows = [row for row in rows if not self._spans.was_resumed(row)]
        return LazySequence(rows, self._spans.span)

    def inside(self, group: GroupId, window: Window) -> Sequence[Span]:
        """Spans of a group."""
        return self._made(self._groups[group], window)

    def innermost(self, thread: ThreadId, at: Nanoseconds) -> Span | None:
        """The innermost call that a thread runs at ``at``."""
        rows = self._threads[thread].covering(at)
        return self._spans.span(rows[-1]) if rows else None

    def innermost_now(self) -> list[Span]:
        """The innermost calls that run now, one of each thread that runs any."""
        return [self._spans.span(lane.stack[-1]) for lane in self._threads.values() if lane.stack]

    def running(self, entity: EntityId) -> RowId | None:
        """The span that an entity runs now, the latest of several."""
        stacks = (lane.stack for lane in self._threads.values() if lane.stack)
        found = (row for stack in stacks for row in stack if self._spans.entity(row) == entity)
        return max(found, default=None)

    def span(self, row: RowId) -> Span:
        """A span by its number."""
        return self._spans.span(row)

    def holders(self, at: Nanoseconds) -> set[EntityId]:
        """The entities with a running or suspended call at ``at``."""
        rows = [row for lane in self._threads.values() for row in lane.covering(at)]
        suspended = {entity for entity, lane in self._suspended.items() if lane.covering(at)}
        return suspended.union(map(self._spans.entity, rows))

    def suspended(self, entity: EntityId, window: Window) -> Sequence[Window]:
        """The stretches in which calls of the entity are suspended; one that lasts ends at ``OPEN``."""
        gaps = self._gaps
        if entity not in self._suspended:
            return ()
        rows = self._suspended[entity].overlapping(window)
        return [Window(gaps.started_at(row), gaps.ended_at(row)) for row in rows]

    def ever_suspended(self) -> Collection[EntityId]:
        """The entities of which a call was ever suspended."""
        return self._suspended.keys()

    def busy(self, thread: ThreadId, window: Window) -> Nanoseconds:
        """How long the thread ran callbacks in the window."""
        lane = self._threads[thread]
        return max(0, lane.busy_until(window.end) - lane.busy_until(window.start))

    def calls(self, entity: EntityId, window: Window) -> int:
        """How many calls of the entity's callback begin in the window."""
        resumed = self._resumed_at[entity]
        again = resumed.before(window.end) - resumed.before(window.start)
        return max(0, self._entities[entity].starting_in(window) - max(0, again))

    def beside(self, entity: EntityId, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """Times at which spans of the entity begin or end, with the nearest after or before ``at``."""
        yield from self._entities[entity].starts_beside(at, step)
        yield from self._entities[entity].ends_beside(at, step)

    def latest_taker(self, message: MessageId) -> Span | None:
        """The one of the latest calls that took a message."""
        if message > self._newest_taken:
            return None
        latest = self._spans.table.newest(Spans.MESSAGE, LATEST_SEARCHED)
        if message not in latest:
            return None
        return self._spans.span(len(self._spans) - len(latest) + latest.index(message))

    def _begin(
        self,
        at: Nanoseconds,
        entity: EntityId,
        thread: ThreadId,
        message: MessageId,
        age: Nanoseconds,
        first: RowId | None = None,
    ) -> RowId:
        self._newest_taken = max(self._newest_taken, message)
        lane = self._threads[thread]
        while lane.stack and lane.stack[-1] < self._uncertain_below:
            self._spans.close(lane.stack.pop(), at)
        row = self._spans.begin(at, entity, thread, message, age, first)
        lane.add(row)
        self._entities[entity].add(row)
        if entity in self._group_of:
            self._group_of[entity].add(row)
        return row

    def _leave(self, entity: EntityId, thread: ThreadId) -> RowId | None:
        """Remove the innermost call of the entity from the thread."""
        stack = self._threads[thread].stack
        for place in range(len(stack) - 1, -1, -1):
            if self._spans.entity(stack[place]) == entity:
                return stack.pop(place)
        return None

    def _made(self, lane: IntervalLane, window: Window) -> Sequence[Span]:
        return LazySequence(lane.overlapping(window), self._spans.span)
