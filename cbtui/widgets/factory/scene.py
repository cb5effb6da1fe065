"""The state of the factory at one moment: who sits, who walks, what lies on which belt."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from functools import cached_property, partial

from cbtui.widgets.lanes.names import short_thread
from cbtui.widgets.lanes.rows import (
    GroupLane,
    MemberLane,
    SoleLane,
    ThreadLane,
    all_lanes,
    ever_ran,
    first_spans,
    never_ran,
)
from sim.diagnosis.words import thread_count
from sim.trace.descriptions import mismatch_of
from sim.trace.events import EntityKind, Reason, ThreadId
from sim.trace.figures.waiting import TimerTick, tick_of, wait_told
from sim.trace.model import (
    Blocked,
    EntityInfo,
    GroupInfo,
    Moment,
    Nanoseconds,
    Position,
    Queue,
    Span,
    Wait,
    Window,
)
from sim.trace.roster import roster_of
from sim.trace.timeline import Timeline

STEPS = 3
"""Steps of a worker's way between the yard and an area."""

_LOOKS_BACK = (64, 8, 1)
_SOON: Nanoseconds = 10_000_000_000
"""How long after the last call of a thread that spins no more another thread is looked for in its place."""


class WorkerState(Enum):
    """What a worker is doing."""

    NEVER = auto()
    """The run is over, and did not need it."""
    NOT_YET = auto()
    IDLE = auto()
    COMES = auto()
    WORKS = auto()
    LEAVES = auto()
    STOPPED = auto()
    """The run is over, or another thread runs what it ran last, or that raised and nobody spins its node."""


@dataclass(frozen=True, slots=True)
class FactoryWorker:
    """A thread. ``span`` is the call it runs or has just run, ``step`` (0 to 2) how far it has walked."""

    name: str
    stay: WorkerState
    span: Span | None = None
    step: int = 0
    blocked: Blocked | Position | None = None
    """The service call in which it is blocked, or the line at which it waits for anything else."""

    @property
    def inside(self) -> bool:
        """Whether it has a seat: its callback runs, though it may still be on its way to it."""
        return self.stay in (WorkerState.COMES, WorkerState.WORKS)

    @property
    def begins(self) -> bool:
        """Whether its call has only just begun: later it works, though it may still be seen on its way."""
        return self.stay is WorkerState.COMES and not self.step


@dataclass(frozen=True, slots=True)
class Belt:
    """The queue or timer of one callback."""

    entity: EntityInfo
    queue: Queue
    wait: Wait | None
    """Only if it is worth telling."""
    tick: TimerTick | None
    mismatch: str = ""
    """Why nothing comes: the publisher does not match; "" for nothing of the kind."""

    @property
    def waits_for_others(self) -> bool:
        """Whether something other than its own last call keeps the callback waiting."""
        return self.wait is not None and not self.wait.is_for_own_call

    @property
    def full(self) -> bool:
        """Whether the queue loses its oldest message to the next one."""
        return self.entity.depth > 0 and self.queue.depth >= self.entity.depth


@dataclass(frozen=True, slots=True)
class Area:
    """A callback group.

    ``number`` is its place in the order of letters. ``visitors`` sit in it, arrive or have just left;
    ``kept`` are callbacks that hold the group on no thread, such as a suspended coroutine.
    """

    group: GroupInfo
    number: int
    belts: tuple[Belt, ...]
    visitors: tuple[FactoryWorker, ...]
    kept: tuple[EntityInfo, ...]
    more: int = 0
    """Callbacks of the group without a belt, if there are too many."""
    crew: str = ""
    """The thread, or the pool, that serves it; "" if one serves all areas, or as long as none did."""

    @property
    def is_open(self) -> bool:
        """Whether it admits every callback."""
        return self.group.is_open

    @property
    def waiting(self) -> int:
        """Callbacks that wait for others at its door."""
        return sum(belt.waits_for_others for belt in self.belts)

    @property
    def inside(self) -> int:
        """Workers in it now."""
        return sum(worker.inside for worker in self.visitors)


@dataclass(frozen=True)
class FactoryScene:
    """The factory at the moment ``now``."""

    timeline: Timeline
    now: Nanoseconds
    workers: tuple[FactoryWorker, ...]
    areas: tuple[Area, ...]
    more: int = 0
    """Groups without an area, if there are too many."""

    @cached_property
    def idle(self) -> int:
        """Workers with nothing to do, who would work."""
        return sum(not worker.inside and worker.stay is not WorkerState.STOPPED for worker in self.workers)

    def waits(self) -> Iterator[Wait]:
        """Every wait for others."""
        return (wait for wait in self.every_wait() if not wait.is_for_own_call)

    def every_wait(self) -> Iterator[Wait]:
        """Every wait that a belt tells, those for a callback's own last call included."""
        for area in self.areas:
            yield from (belt.wait for belt in area.belts if belt.wait)


def scene_of(timeline: Timeline, now: Nanoseconds, glance: Nanoseconds) -> FactoryScene:
    """Return the factory at ``now``; who began or ended less than ``glance`` nanoseconds ago is shown
    walking.
    """
    return _SceneBuilder(timeline, now, max(glance, 1)).scene()


class _SceneBuilder:
    """One scene while it is put together."""

    def __init__(self, timeline: Timeline, now: Nanoseconds, glance: Nanoseconds) -> None:
        self._timeline = timeline
        self._now = now
        self._glance = glance
        self._moment: Moment = timeline.moment(now)
        self._numbers = {group: place for place, group in enumerate(timeline.groups)}
        ended = timeline.ended
        self._is_over = ended is not None and now >= ended.t and not ended.time_was_up

    def scene(self) -> FactoryScene:
        members: dict[int, list[EntityInfo]] = {}
        groups: dict[int, GroupInfo] = {}
        workers = []
        for lane in all_lanes(self._timeline, ""):
            match lane:
                case ThreadLane(thread) if thread.executor or ever_ran(self._timeline, thread.id, self._now):
                    workers.append(self._worker(thread.id, short_thread(thread.name)))
                case GroupLane(group):
                    groups[group.id], members[group.id] = group, []
                case SoleLane(entity, group):
                    groups[group.id], members[group.id] = group, [entity]
                case MemberLane(entity, group):
                    members[group.id].append(entity)
        hired = thread_count(self._timeline)
        workers += [
            FactoryWorker(f"worker {number + 1}", self._before_work())
            for number in range(len(workers), hired)
        ]
        crews = {group: self._crew(members[group]) for group in groups}
        several = len({*crews.values()} - {""}) > 1
        areas = tuple(
            self._area(group, members[group.id], workers, crews[group.id] if several else "")
            for group in groups.values()
        )
        more = roster_of(self._timeline).groups - len(areas)
        return FactoryScene(self._timeline, self._now, tuple(workers), areas, more)

    def _worker(self, thread: ThreadId, name: str) -> FactoryWorker:
        span = self._moment.running.get(thread)
        if span is not None:
            since = self._now - span.start
            blocked = self._moment.blocked.get(thread) or self._waits_inside(thread)
            if since < self._glance and blocked is None:
                return FactoryWorker(name, WorkerState.COMES, span, self._step(since))
            return FactoryWorker(name, WorkerState.WORKS, span, blocked=blocked)
        span = self._last_finished(thread)
        if span is not None:
            return FactoryWorker(
                name, WorkerState.LEAVES, span, self._step(self._now - span.end_at(self._now))
            )
        if self._has_stopped(thread):
            return FactoryWorker(name, WorkerState.STOPPED)
        ran = ever_ran(self._timeline, thread, self._now)
        return FactoryWorker(name, WorkerState.IDLE if ran else self._before_work(thread))

    def _waits_inside(self, thread: ThreadId) -> Position | None:
        """Where a thread's call waits at its line."""
        position = self._timeline.position_on(thread, self._now)
        return position if position is not None and position.waits else None

    def _has_stopped(self, thread: ThreadId) -> bool:
        """Whether the run is over, or a thread, no worker, has raised and left a node that nobody spins.

        Also whether another such thread has taken over what it ran last.
        """
        if self._is_over or self._is_relieved(thread):
            return True
        entities = self._timeline.entities
        waits = self._moment.waiting.values()
        unspun = {entities[each.entity].node for each in waits if each.reason is Reason.NOBODY_SPINS}
        if not unspun or self._timeline.threads[thread].executor:
            return False
        last = self._timeline.spans_on(thread, Window(0, self._now + 1))[-1:]
        return any(span.error and entities[span.entity].node in unspun for span in last)

    def _is_relieved(self, thread: ThreadId) -> bool:
        spinning = {each.id for each in self._timeline.threads.values() if not each.executor}
        if thread not in spinning or len(spinning) == 1:
            return False
        last = self._timeline.spans_on(thread, Window(0, self._now + 1))[-1:]
        others = (
            self._timeline.spans_of(span.entity, Window(end, min(end + _SOON, self._now) + 1))
            for span in last
            if (end := span.end) is not None
        )
        return any(each.thread in spinning - {thread} for calls in others for each in calls)

    def _before_work(self, thread: ThreadId = 0) -> WorkerState:
        """The state of a thread that has run nothing yet; 0 for one that has not been started."""
        return WorkerState.NEVER if never_ran(self._timeline, thread) else WorkerState.NOT_YET

    def _step(self, since: Nanoseconds) -> int:
        return min(STEPS - 1, STEPS * since // self._glance)

    def _last_finished(self, thread: ThreadId) -> Span | None:
        """Return the call that ended last, less than a glance ago; examines no earlier ones."""
        for part in _LOOKS_BACK:
            window = Window(self._now - self._glance // part, self._now + 1)
            ended = [
                span
                for span in self._timeline.spans_on(thread, window)
                if span.end is not None and self._now - self._glance < span.end <= self._now
            ]
            if ended:
                return max(ended, key=lambda span: (span.end_at(self._now), span.number))
        return None

    def _crew(self, members: Sequence[EntityInfo]) -> str:
        """The thread or pool that ran the first calls of a group; "" for none yet."""
        for member in members:
            for span in first_spans(partial(self._timeline.spans_of, member.id), self._now)[:1]:
                thread = self._timeline.threads[span.thread]
                name = short_thread(thread.name)
                return name.rpartition("_")[0] if thread.executor else name.partition(" (")[0]
        return ""

    def _area(
        self, group: GroupInfo, members: list[EntityInfo], workers: list[FactoryWorker], crew: str
    ) -> Area:
        ids = {member.id for member in members}
        visitors = tuple(worker for worker in workers if worker.span and worker.span.entity in ids)
        seated = {worker.span.entity for worker in visitors if worker.inside and worker.span}
        holders = self._moment.holders.get(group.id, ())
        kept = tuple(self._timeline.entities[holder] for holder in holders if holder not in seated)
        belts = tuple(self._belt(member) for member in members)
        more = roster_of(self._timeline).size(group.id) - len(belts)
        return Area(group, self._numbers[group.id], belts, visitors, kept, more, crew)

    def _belt(self, entity: EntityInfo) -> Belt:
        wait = wait_told(entity.id, self._moment, self._timeline)
        tick = tick_of(entity.id, self._now, self._timeline) if entity.kind is EntityKind.TIMER else None
        queue = self._moment.queues.get(entity.id, _NO_QUEUE)
        return Belt(entity, queue, wait, tick, mismatch_of(entity, queue, self._timeline, self._now))


_NO_QUEUE = Queue(0, 0)
