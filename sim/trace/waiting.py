"""The waits of ready callbacks, with their reasons."""

from collections import defaultdict
from collections.abc import Iterator, Sequence

from sim.trace.events import EntityId, Reason, WaitStarted
from sim.trace.lazy import LazySequence
from sim.trace.model import Nanoseconds, Wait, Window
from sim.trace.storage.intervals import OPEN, IntervalLane, Intervals, RowId, end_or_none
from sim.trace.storage.spill_file import SpillFile

_REASONS = tuple(Reason)


class Waiting(Intervals):
    """All waits of a run, by entity."""

    SINCE, ENTITY, HOLDER, REASON, WORKERS_BUSY = range(2, 7)

    def __init__(self, spill: SpillFile) -> None:
        super().__init__(spill, more=5)
        self._lanes: defaultdict[EntityId, IntervalLane] = defaultdict(lambda: IntervalLane(self))
        self._latest: dict[EntityId, RowId] = {}
        self._none = IntervalLane(self)
        self._open: set[EntityId] = set()
        self._changed: Nanoseconds = 0
        """When a wait last started or ended."""

    def start(self, event: WaitStarted) -> None:
        """Start a wait, or continue one for another reason."""
        latest = self._latest.get(event.entity)
        begun = min(event.since, event.t)
        if latest is not None and self._goes_on(latest, event.since):
            begun = event.t
        self.finish(event.entity, event.t)
        reason = _REASONS.index(event.reason)
        row = self.open(begun, event.since, event.entity, event.holder, reason, event.workers_busy)
        self._lanes[event.entity].add(row)
        self._latest[event.entity] = row
        self._open.add(event.entity)
        self._changed = max(self._changed, event.t)

    def finish(self, entity: EntityId, at: Nanoseconds) -> None:
        """End the wait of an entity."""
        latest = self._latest.get(entity)
        if latest is not None and self.ended_at(latest) == OPEN:
            self.close(latest, at)
            self._open.discard(entity)
            self._changed = max(self._changed, at)

    def of(self, entity: EntityId, window: Window) -> Sequence[Wait]:
        """Waits of an entity."""
        return LazySequence(self._of(entity).overlapping(window), self._wait)

    def at(self, entity: EntityId, at: Nanoseconds) -> Wait | None:
        """The wait of an entity that is in progress at ``at``."""
        rows = self._of(entity).covering(at)
        return self._wait(rows[-1]) if rows else None

    def waiting(self, at: Nanoseconds) -> Sequence[EntityId]:
        """The entities that may wait at ``at``, in order; for the latest moment exactly those that do."""
        return sorted(self._open if at >= self._changed else self._lanes)

    def beside(self, entity: EntityId, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """Starts of waits of the entity, with the nearest after or before ``at``."""
        return self._of(entity).starts_beside(at, step)

    def _of(self, entity: EntityId) -> IntervalLane:
        return self._lanes.get(entity, self._none)

    def _goes_on(self, latest: RowId, since: Nanoseconds) -> bool:
        return self.ended_at(latest) == OPEN or self.table.cell(latest, self.SINCE) == since

    def _wait(self, row: RowId) -> Wait:
        start, end, since, entity, holder, reason, workers_busy = self.table.row(row)
        return Wait(start, end_or_none(end), since, entity, _REASONS[reason], holder, bool(workers_busy))
