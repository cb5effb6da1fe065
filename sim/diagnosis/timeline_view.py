"""A view of the latest part of a run: what several rules query is computed once."""

from bisect import bisect_left
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from operator import attrgetter

from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityId, EntityKind, NodeId, NoticeKind, ProcessId, Reason, ThreadId
from sim.trace.figures.concurrency import Concurrency
from sim.trace.model import Blocked, Call, EntityInfo, Moment, Nanoseconds, Position, Span, Wait, Window
from sim.trace.timeline import Timeline

_FEW = 100
"""Entities of a program that is looked into at each check, idle ones included."""


@dataclass(frozen=True, slots=True)
class LongWait:
    """The time from a callback's readiness to its call, or to now (``is_open``), in parts by reason."""

    entity: EntityId
    since: Nanoseconds
    until: Nanoseconds
    is_open: bool
    parts: tuple[Wait, ...]

    def length(self, part: Wait) -> Nanoseconds:
        """The length of a part, in nanoseconds."""
        return part.end_at(self.until) - part.start

    def longest_part(self, before: Nanoseconds) -> Wait:
        """The part that had lasted longest at a time; the first of equal ones."""
        return max(self.parts, key=lambda part: min(part.end_at(self.until), before) - part.start)

    def because(self, reason: Reason) -> tuple[Wait, ...]:
        """The parts with a reason that another callback caused."""
        return tuple(part for part in self.parts if part.reason is reason and part.holder != part.entity)


class TimelineView:
    """A timeline from the start of ``window`` to its end, including intervals that reach into it."""

    def __init__(self, timeline: Timeline, window: Window, concurrency: Concurrency) -> None:
        self.timeline = timeline
        self.window = window
        self._concurrency = concurrency
        self._spans: dict[EntityId, tuple[Span, ...]] = {}
        self._waits: dict[EntityId, tuple[LongWait, ...]] = {}
        self._ends: dict[NodeId, Nanoseconds | None] = {}

    @property
    def end(self) -> Nanoseconds:
        """The time of the latest event."""
        return self.timeline.end

    @property
    def known(self) -> Nanoseconds:
        """How long the trace has told everything."""
        return self.timeline.end - self.timeline.begun

    @cached_property
    def now(self) -> Moment:
        """The latest moment."""
        return self.timeline.moment(self.end)

    @cached_property
    def threads_needed(self) -> int:
        """The most threads that ran callbacks at once since the run began."""
        return self._concurrency.peak(self.end)

    def end_of_program(self, entity: EntityInfo) -> Nanoseconds | None:
        """When the program of an entity's node ended; None while it runs, or if it is unknown."""
        ended = self.timeline.processes_ended
        if not ended:
            return None
        if entity.node not in self._ends:
            self._ends[entity.node] = ended.get(self._process_of(entity.node))
        return self._ends[entity.node]

    def _process_of(self, node: NodeId) -> ProcessId:
        whole = Window(0, self.window.end)
        for entity in self.timeline.entities.values():
            if entity.node == node:
                for span in self.timeline.spans_of(entity.id, whole)[:1]:
                    thread = self.timeline.threads.get(span.thread)
                    return 0 if thread is None else thread.process
        return 0

    @cached_property
    def unanswered(self) -> frozenset[int]:
        """The calls that have no reply yet."""
        return frozenset(call.id for call in self.now.pending_calls)

    def entities(self, *kinds: EntityKind) -> Iterator[EntityInfo]:
        """The entities that were or are active in the window, of some kinds (none given: of all).

        Idle entities break no rule, and cost nothing.
        """
        return (each for each in self._active if not kinds or each.kind in kinds)

    @property
    def few_entities(self) -> Collection[EntityInfo]:
        """All entities, idle ones included; none if there are many, as this has to stay cheap."""
        every = self.timeline.entities
        return every.values() if len(every) <= _FEW else ()

    @cached_property
    def _active(self) -> list[EntityInfo]:
        entities, active = self.timeline.entities, self.timeline.active_since(self.window.start)
        return [entities[each] for each in sorted(active)]

    def spans(self, entity: EntityId) -> tuple[Span, ...]:
        """The calls of an entity that reach into the window, in order of start."""
        if entity not in self._spans:
            self._spans[entity] = tuple(self.timeline.spans_of(entity, self.window))
        return self._spans[entity]

    def waits(self, entity: EntityId) -> tuple[LongWait, ...]:
        """The waits of an entity that reach into the window, uncut, in order of start."""
        if entity not in self._waits:
            self._waits[entity] = tuple(self._long_waits(entity))
        return self._waits[entity]

    def calls(self) -> Sequence[Call]:
        """The service calls that were sent in the window."""
        every = self.timeline.calls
        return every[bisect_left(every, self.window.start, key=attrgetter("sent")) :]

    @cached_property
    def blocked(self) -> tuple[Blocked, ...]:
        """The intervals that reach into the window in which threads were blocked in a call."""
        return tuple(self._blocked_in(self.window))

    @cached_property
    def positions(self) -> tuple[Position, ...]:
        """Where callbacks are in their code at the end."""
        found = (self.timeline.position_on(thread, self.end) for thread in self.now.running)
        return tuple(each for each in found if each is not None)

    @cached_property
    def nested_spinners(self) -> frozenset[EntityId]:
        """The callbacks that spun their own executor and may hang in that; rules on waits skip them."""
        return frozenset(each.entity for each in self.timeline.spin_clashes if each.entity)

    @cached_property
    def unspun(self) -> Mapping[NodeId, LongWait]:
        """The longest wait of each node of a running program for which nobody spins it any more, or yet."""
        raised = self._raised_though_threads_go_on
        longest: dict[NodeId, LongWait] = {}
        for entity in self.entities():
            wait = next(reversed(self.waits(entity.id)), None)
            if wait is None or not wait.is_open or wait.parts[-1].reason is not Reason.NOBODY_SPINS:
                continue
            if raised is not None and raised - wait.parts[-1].start < SECOND:
                continue  # nobody spins because of what was raised
            known = longest.get(entity.node)
            is_longer = known is None or wait.parts[-1].start < known.parts[-1].start
            if is_longer and self.end_of_program(entity) is None:
                longest[entity.node] = wait
        return longest

    @property
    def _raised_though_threads_go_on(self) -> Nanoseconds | None:
        """When an exception ended the main thread of the only program, whose other threads go on."""
        raised = (each.t for each in self.timeline.notices if each.kind is NoticeKind.PROGRAM_RAISED)
        return None if self.timeline.processes_ended else next(raised, None)

    def stood_in_call(self, entity: EntityId, start: Nanoseconds, end: Nanoseconds) -> bool:
        """Whether a callback was blocked in a call between two times."""
        return any(each.entity == entity for each in self._blocked_in(Window(start, end)))

    def _blocked_in(self, window: Window) -> Iterator[Blocked]:
        for thread in self.timeline.threads:
            yield from self.timeline.blocks_on(thread, window)

    def _long_waits(self, entity: EntityId) -> Iterator[LongWait]:
        waits = self.timeline.waits_of(entity, self.window)
        if waits and waits[0].start > waits[0].since:
            waits = self.timeline.waits_of(entity, Window(waits[0].since, self.window.end))
        for since, series in groupby(waits, key=attrgetter("since")):
            parts = tuple(series)
            last = parts[-1]
            until = last.end_at(self.end)
            if until > self.window.start:
                yield LongWait(entity, since, until, last.end is None, parts)


def raised_last(node: NodeId, timeline: Timeline) -> Span | None:
    """Return the last call that the executor of a node ran, if it raised; else None.

    Workers may begin one more before ``spin`` raises what a MultiThreadedExecutor kept.
    """
    whole = Window(0, timeline.end + 1)
    members = (each.id for each in timeline.entities.values() if each.node == node)
    own = [span for each in members for span in timeline.spans_of(each, whole)[-1:]]
    if not own:
        return None
    thread = max(own, key=attrgetter("number")).thread
    lanes = (timeline.spans_on(each, whole)[-2:] for each in pool_of(thread, timeline))
    latest = sorted((span for lane in lanes for span in lane), key=attrgetter("number"), reverse=True)
    return next((span for span in latest[: 1 + is_worker(thread, timeline)] if span.error), None)


def pool_of(thread: ThreadId, timeline: Timeline) -> tuple[ThreadId, ...]:
    """The worker threads of the same executor; only the thread itself if it is not a worker."""
    if not is_worker(thread, timeline):
        return (thread,)
    executor = timeline.threads[thread].executor
    return tuple(each.id for each in timeline.threads.values() if each.executor == executor)


def is_worker(thread: ThreadId, timeline: Timeline) -> bool:
    """Whether a thread is one of the workers of a MultiThreadedExecutor."""
    known = timeline.threads.get(thread)
    return known is not None and known.executor != 0
