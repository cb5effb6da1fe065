"""A timeline without cleverness, to compare with: it sorts the events and looks through all of them."""

from collections import defaultdict
from collections.abc import Iterable

from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackFailed,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    CallBlocked,
    CallId,
    CallUnblocked,
    EntityAppeared,
    EntityId,
    EntityKind,
    EntityReady,
    GroupId,
    Logged,
    MessageDropped,
    MessageId,
    Published,
    Scanned,
    ServiceCalled,
    ServiceReplied,
    ThreadId,
    WaitEnded,
    WaitStarted,
)
from sim.trace.model import Blocked, Queue, QueuedMessage, Span, Wait, Window


def overlaps(start: int, end: int | None, window: Window) -> bool:
    """Whether an interval shares time with a window; an instant does if it lies in it."""
    if window.length <= 0 or start >= window.end:
        return False
    return start >= window.start or end is None or end > window.start


class Naive:
    """Answers like ``Timeline``, by going through everything each time."""

    def __init__(self, events: Iterable[AnyEvent]) -> None:
        self.events = sorted(events, key=lambda event: event.t)
        self.spans: list[Span] = []
        self.waits: list[Wait] = []
        self._fold_spans()
        self._fold_waits()
        self.blocks: list[Blocked] = []
        self._fold_blocks()

    def _fold_spans(self) -> None:
        suspended: defaultdict[EntityId, list[Span]] = defaultdict(list)
        for event in self.events:
            match event:
                case CallbackStarted(t, entity, thread, message, age, _):
                    self.spans.append(Span(t, None, entity, thread, message, age))
                case CallbackResumed(t, entity, thread):
                    before = suspended[entity].pop(0)
                    self.spans.append(Span(t, None, entity, thread, before.message, before.age))
                case CallbackSuspended(t, entity, thread):
                    span = self._open(entity, thread)
                    span.end = t
                    suspended[entity].append(span)
                case CallbackFailed(_, entity, thread, error, file, line):
                    span = self._open(entity, thread)
                    span.error, span.raised_at = error, (file, line)
                case CallbackEnded(t, entity, thread):
                    self._open(entity, thread).end = t

    def _open(self, entity: EntityId, thread: ThreadId) -> Span:
        return next(s for s in reversed(self.spans) if (s.entity, s.thread, s.end) == (entity, thread, None))

    def _fold_waits(self) -> None:
        for event in self.events:
            if not isinstance(event, WaitStarted | WaitEnded):
                continue
            mine = [wait for wait in self.waits if wait.entity == event.entity]
            open_one = mine[-1] if mine and mine[-1].end is None else None
            if open_one is not None:
                open_one.end = event.t
            if isinstance(event, WaitStarted):
                same_series = open_one is not None or (bool(mine) and mine[-1].since == event.since)
                start = event.t if same_series else event.since
                reason, holder, busy = event.reason, event.holder, event.workers_busy
                self.waits.append(Wait(start, None, event.since, event.entity, reason, holder, busy))

    def _fold_blocks(self) -> None:
        for event in self.events:
            match event:
                case CallBlocked(t, call, thread, entity, service):
                    self.blocks.append(Blocked(t, None, thread, entity, call, service))
                case CallUnblocked(t, call, _):
                    next(each for each in self.blocks if each.call == call).end = t

    def blocked(self, at: int) -> dict[ThreadId, Blocked]:
        covering = [b for b in self.blocks if b.start <= at and (b.end is None or b.end > at)]
        return {blocked.thread: blocked for blocked in covering}

    def blocks_on(self, thread: ThreadId, window: Window) -> list[Blocked]:
        return [b for b in self.blocks if b.thread == thread and overlaps(b.start, b.end, window)]

    def kind(self, entity: EntityId) -> EntityKind:
        kinds = (e.kind for e in self.events if isinstance(e, EntityAppeared) and e.entity == entity)
        return next(kinds)

    def born(self, entity: EntityId, number: int) -> int | None:
        """When the message of that number was published, or the request sent."""
        if self.kind(entity) is not EntityKind.SERVICE:
            return self.published_at(number)
        times = (e.t for e in self.events if isinstance(e, ServiceCalled) and e.call == number)
        return next(times, None)

    def logs_until(self, at: int) -> int:
        return sum(isinstance(event, Logged) and event.t <= at for event in self.events)

    def spans_where(self, window: Window, **wanted: int) -> list[Span]:
        """Spans in a window with the wanted thread or entity."""
        return [
            span
            for span in self.spans
            if overlaps(span.start, span.end, window)
            and all(getattr(span, name) == value for name, value in wanted.items())
        ]

    def spans_in(self, group: GroupId, window: Window) -> list[Span]:
        members = self.members(group)
        return [span for span in self.spans_where(window) if span.entity in members]

    def members(self, group: GroupId) -> list[EntityId]:
        return [e.entity for e in self.events if isinstance(e, EntityAppeared) and e.group == group]

    def waits_of(self, entity: EntityId, window: Window) -> list[Wait]:
        mine = [w for w in self.waits if w.entity == entity and overlaps(w.start, w.end, window)]
        return sorted(mine, key=lambda wait: wait.start)

    def busy(self, thread: ThreadId, window: Window) -> float:
        """Counts the nanoseconds, so only for short runs."""
        if window.length <= 0:
            return 0.0
        end = max((event.t for event in self.events), default=0)
        mine = [span for span in self.spans if span.thread == thread]
        ran = sum(
            any(span.start <= t < span.end_at(end) for span in mine)
            for t in range(window.start, min(window.end, end))
        )
        return ran / window.length

    def drops(self, window: Window, entity: EntityId | None = None) -> int:
        return sum(
            isinstance(event, MessageDropped)
            and entity in (None, event.entity)
            and window.start <= event.t < window.end
            for event in self.events
        )

    def published_at(self, message: MessageId) -> int | None:
        times = (e.t for e in self.events if isinstance(e, Published) and e.message == message)
        return next(times, None)

    def queue(self, entity: EntityId, at: int) -> Queue:
        """Plays the queue through."""
        waiting: list[tuple[MessageId, int]] = []
        dropped = depth = 0
        for event in self.events:
            if event.t > at:
                break
            match event:
                case EntityReady(t, who, depth_then, message) if who == entity:
                    waiting.append((message, t))
                    depth = depth_then
                case MessageDropped(_, who, depth_then, message) if who == entity:
                    waiting = [each for each in waiting if each[0] != message]
                    dropped += 1
                    depth = depth_then
                case CallbackStarted(_, who, _, message, _, depth_then) if who == entity:
                    waiting = [each for each in waiting if each[0] != message]
                    depth = depth_then
        return Queue(depth, dropped, [self._queued(entity, *each) for each in waiting])

    def _queued(self, entity: EntityId, message: MessageId, arrived: int) -> QueuedMessage:
        born = self.born(entity, message)
        return QueuedMessage(message, arrived if born is None else born, arrived)

    def running(self, at: int) -> dict[ThreadId, Span]:
        """The top of each thread's stack of calls."""
        covering = [s for s in self.spans if s.start <= at and (s.end is None or s.end > at)]
        return {span.thread: span for span in covering}

    def waiting(self, at: int) -> dict[EntityId, Wait]:
        covering = [w for w in self.waits if w.start <= at and (w.end is None or w.end > at)]
        return {w.entity: w for w in sorted(covering, key=lambda wait: wait.start)}

    def holders(self, group: GroupId, at: int) -> tuple[EntityId, ...]:
        """Counts the calls that have begun and not ended."""
        inside: defaultdict[EntityId, int] = defaultdict(int)
        for event in self.events:
            if event.t <= at and isinstance(event, CallbackStarted):
                inside[event.entity] += 1
            elif event.t <= at and isinstance(event, CallbackEnded):
                inside[event.entity] -= 1
        return tuple(entity for entity in self.members(group) if inside[entity])

    def pending(self, at: int) -> tuple[CallId, ...]:
        out: list[CallId] = []
        for event in self.events:
            if event.t <= at and isinstance(event, ServiceCalled):
                out.append(event.call)
            elif event.t <= at and isinstance(event, ServiceReplied):
                out.remove(event.call)
        return tuple(out)

    def neighbour(self, at: int, step: int) -> int | None:
        times = {span.start for span in self.spans} | {wait.start for wait in self.waits}
        times |= {span.end for span in self.spans if span.end is not None}
        times |= {block.start for block in self.blocks}
        times |= {block.end for block in self.blocks if block.end is not None}
        times |= {event.t for event in self.events if isinstance(event, MessageDropped)}
        if step > 0:
            return min((time for time in times if time > at), default=None)
        return max((time for time in times if time < at), default=None)

    def scan_seen(self, at: int) -> Scanned | None:
        scans = {event.message: event for event in self.events if isinstance(event, Scanned)}
        taken = [
            scans[event.message]
            for event in self.events
            if isinstance(event, CallbackStarted)
            and event.t <= at
            and event.message in scans
            and self.kind(event.entity) is EntityKind.SUBSCRIPTION
        ]
        return taken[-1] if taken else None
