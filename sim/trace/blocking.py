"""The intervals in which threads were blocked in a service call."""

from collections import defaultdict
from collections.abc import Iterator, Sequence

from sim.trace.decisions import Decisions
from sim.trace.events import CallBlocked, CallUnblocked, EntityId, ThreadId
from sim.trace.lazy import LazySequence
from sim.trace.model import Blocked, Deed, Nanoseconds, Window
from sim.trace.storage.intervals import IntervalLane, Intervals, RowId, end_or_none
from sim.trace.storage.spill_file import SpillFile


class Blocking(Intervals):
    """The intervals in which threads were blocked, by thread and by callback."""

    THREAD, ENTITY, CALL, SERVICE = range(2, 6)

    def __init__(self, spill: SpillFile, decisions: Decisions) -> None:
        super().__init__(spill, more=4)
        self._decisions = decisions
        self._services: dict[str, int] = {}
        self._by_thread: defaultdict[ThreadId, IntervalLane] = defaultdict(lambda: IntervalLane(self))
        self._by_entity: defaultdict[EntityId, IntervalLane] = defaultdict(lambda: IntervalLane(self))
        self._standing: dict[ThreadId, RowId] = {}

    def start(self, event: CallBlocked) -> None:
        """Start an interval."""
        self.go_on(event.thread, event.t)
        service = self._services.setdefault(event.service, len(self._services))
        row = self.open(event.t, event.thread, event.entity, event.call, service)
        self._by_thread[event.thread].add(row)
        self._by_entity[event.entity].add(row)
        self._standing[event.thread] = row
        self._decisions.add(event.t, Deed.BLOCKED, row)

    def finish(self, event: CallUnblocked) -> None:
        """End the interval of a call; ignored if its thread is not blocked in it."""
        row = self._standing.get(event.thread)
        if row is not None and self.table.cell(row, self.CALL) == event.call:
            self.go_on(event.thread, event.t)

    def go_on(self, thread: ThreadId, at: Nanoseconds) -> None:
        """End a thread's interval, since it runs again; the event of its return may be lost."""
        row = self._standing.pop(thread, None)
        if row is not None:
            self.close(row, at)
            self._decisions.add(at, Deed.UNBLOCKED, row)

    def on(self, thread: ThreadId, window: Window) -> Sequence[Blocked]:
        """The intervals in which a thread was blocked."""
        return LazySequence(self._by_thread[thread].overlapping(window), self.blocked)

    def at(self, at: Nanoseconds) -> Iterator[Blocked]:
        """The threads that are blocked at ``at``."""
        for lane in list(self._by_thread.values()):
            yield from map(self.blocked, lane.covering(at))

    def beside(self, entity: EntityId, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """The nearest start or end of an interval of the entity's callback, after or before ``at``."""
        yield from self._by_entity[entity].starts_beside(at, step)
        yield from self._by_entity[entity].ends_beside(at, step)

    def blocked(self, row: RowId) -> Blocked:
        """One interval, as a value."""
        start, end, thread, entity, call, service = self.table.row(row)
        return Blocked(start, end_or_none(end), thread, entity, call, list(self._services)[service])
