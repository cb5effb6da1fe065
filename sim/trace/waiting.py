"""Which callbacks were ready and did not run, when and why."""

from array import array
from collections import defaultdict
from collections.abc import Iterator, Sequence

from sim.trace.events import EntityId, Reason, WaitStarted
from sim.trace.intervals import OPEN, Answer, Intervals, Lane, Row
from sim.trace.model import Nanoseconds, Wait, Window


class Waiting(Intervals):
    """The columns of all waits, and a lane of them for each entity."""

    def __init__(self) -> None:
        super().__init__()
        self._since = array("q")
        self._entities = array("i")
        self._holders = array("i")
        self._reasons: list[Reason] = []
        self._workers_busy = array("b")
        self._lanes: defaultdict[EntityId, Lane] = defaultdict(lambda: Lane(self))
        self._latest: dict[EntityId, Row] = {}

    def start(self, event: WaitStarted) -> None:
        """An entity begins to wait, or goes on waiting for another reason."""
        latest = self._latest.get(event.entity)
        begun = min(event.since, event.t)
        if latest is not None and (self.ends[latest] == OPEN or self._since[latest] == event.since):
            begun = event.t
        self.finish(event.entity, event.t)
        self._since.append(event.since)
        self._entities.append(event.entity)
        self._holders.append(event.holder)
        self._reasons.append(event.reason)
        self._workers_busy.append(event.workers_busy)
        row = self.open(begun)
        self._lanes[event.entity].add(row)
        self._latest[event.entity] = row

    def finish(self, entity: EntityId, at: Nanoseconds) -> None:
        """An entity waits no longer."""
        latest = self._latest.get(entity)
        if latest is not None and self.ends[latest] == OPEN:
            self.close(latest, at)

    def of(self, entity: EntityId, window: Window) -> Sequence[Wait]:
        """Waits of an entity."""
        return Answer(self._lanes[entity].overlapping(window), self._wait)

    def at(self, entity: EntityId, at: Nanoseconds) -> Wait | None:
        """The wait of an entity that is in progress at ``at``."""
        rows = self._lanes[entity].covering(at)
        return self._wait(rows[-1]) if rows else None

    def beside(self, entity: EntityId, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """Starts of waits of the entity, with the nearest after or before ``at``."""
        return self._lanes[entity].starts_beside(at, step)

    def _wait(self, row: Row) -> Wait:
        return Wait(
            self.starts[row],
            self.end(row),
            self._since[row],
            self._entities[row],
            self._reasons[row],
            self._holders[row],
            bool(self._workers_busy[row]),
        )
