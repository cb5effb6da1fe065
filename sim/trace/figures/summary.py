"""The summary of a run in figures: callbacks, threads, service calls and the robot."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby, pairwise

from sim.quantities.durations import LEAST
from sim.trace.descriptions import node_name, silent_topics, why_waiting
from sim.trace.events import EntityId, NoticeKind, RobotMoved, VelocityCommanded
from sim.trace.figures.concurrency import threads_at_once
from sim.trace.figures.losses import losses
from sim.trace.figures.statistics import pending_age
from sim.trace.figures.waiting import waited_by
from sim.trace.incremental import Incremental, collect, run_to_end, split
from sim.trace.model import Call, EntityInfo, Nanoseconds, Wait, Window
from sim.trace.timeline import Timeline

_BETWEEN_POSES: Nanoseconds = 20_000_000
"""Approximate time between two poses of the robot."""


@dataclass(frozen=True, slots=True)
class WaitInRun:
    """A wait of a callback, or of its next message; ``why`` is the reason of most of that time."""

    length: Nanoseconds
    why: str


@dataclass(frozen=True, slots=True)
class CallbackFigures:
    """The figures of one callback.

    ``running`` is the share (0 upwards; above 1 if calls overlap) of the run that its calls took; ``late``
    the age of the oldest message it took, a timer's greatest lateness, or how long a call waits at the end.
    """

    entity: EntityInfo
    name: str
    group: str
    calls: int
    running: float
    longest_wait: WaitInRun | None
    late: Nanoseconds
    drops: int | None
    """None if it is not known."""
    errors: int


_LATE: Nanoseconds = 50_000_000


def without_waits(callbacks: Iterable[CallbackFigures]) -> str:
    """Say that no callback is known to have waited for others; some may be late, as where nothing spins."""
    is_late = any(each.late >= _LATE for each in callbacks)
    return "none for a group or a thread" if is_late else "none, every callback ran as soon as it was ready"


@dataclass(frozen=True, slots=True)
class ServiceFigures:
    """Calls of one service; ``round_trips`` are the times from request to reply."""

    service: str
    calls: int
    round_trips: tuple[Nanoseconds, ...]


@dataclass(frozen=True, slots=True)
class RobotFigures:
    """The robot's motion: commanded turns and their total radians, metres travelled, and the last pose."""

    turns: int
    turned: float
    travelled: float
    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True)
class Summary:
    """The figures of a run; ``robot`` is None for a run without one."""

    target: str
    clock: str
    length: Nanoseconds
    ending: str
    lost: int
    callbacks: tuple[CallbackFigures, ...]
    threads_used: int
    threads_at_once: int
    services: tuple[ServiceFigures, ...]
    robot: RobotFigures | None
    silent: tuple[str, ...]
    """The topics of subscriptions on which nothing came."""
    is_short: bool
    """Whether the time was up before the program had made a node."""
    raised_at_end: tuple[str, ...]
    """How programs failed once they were told to end: file and line, and the exception."""


def summarise(timeline: Timeline) -> Summary:
    """Summarise a whole timeline."""
    whole = Window(0, timeline.end + 1)
    spans = [timeline.spans_on(thread, whole) for thread in timeline.threads]
    return Summary(
        target=timeline.started.target if timeline.started else "",
        clock=timeline.started.clock if timeline.started else "",
        length=timeline.end - timeline.begun,
        ending=timeline.ended.reason if timeline.ended else "",
        lost=timeline.lost,
        callbacks=tuple(_callbacks(timeline, whole)),
        threads_used=sum(bool(of_thread) for of_thread in spans),
        threads_at_once=threads_at_once(timeline, whole),
        services=tuple(_services(timeline.calls)),
        robot=run_to_end(robot_incrementally(timeline, whole)),
        silent=silent_topics(timeline),
        raised_at_end=tuple(each.text for each in timeline.notices if each.kind is NoticeKind.RAISED_AT_END),
        is_short=not timeline.nodes and timeline.ended is not None and timeline.ended.time_was_up,
    )


def _callbacks(timeline: Timeline, whole: Window) -> Iterator[CallbackFigures]:
    names, length = _names(timeline), timeline.end - timeline.begun
    for entity in timeline.entities.values():
        spans = timeline.spans_of(entity.id, whole)
        waits = timeline.waits_of(entity.id, whole)
        drops = losses(timeline, entity, whole)
        if not (entity.callback or spans or waits or drops):
            continue
        group = timeline.groups.get(entity.group)
        running = sum(span.end_at(timeline.end) - max(span.start, timeline.begun) for span in spans)
        yield CallbackFigures(
            entity=entity,
            name=names[entity.id],
            group=group.letter if group else "",
            calls=timeline.calls_of(entity.id, whole),
            running=running / length if length else 0.0,
            longest_wait=_longest(waits, timeline),
            late=max([span.age for span in spans] + [pending_age(timeline, entity, whole)]),
            drops=drops,
            errors=sum(bool(span.error) for span in spans),
        )


def _names(timeline: Timeline) -> dict[EntityId, str]:
    """The name of each entity: its callback, with topic, service or node if the name is not unique.

    The server and a client of an action have its name both, so that the node tells them apart; callbacks
    of one name in one node are told apart by their lines.
    """
    entities = timeline.entities.values()
    spoken = {entity.id: entity.spoken_name for entity in entities}
    shared = Counter(spoken.values())
    placed = {
        entity.id: (_known_by(entity) or node_name(entity.node, timeline))
        for entity in entities
        if shared[spoken[entity.id]] > 1
    }
    lines: defaultdict[tuple[str, str], set[int]] = defaultdict(set)
    for each, place in placed.items():
        lines[spoken[each], place].add(timeline.entities[each].first_line)
    for each, place in placed.items():
        first = timeline.entities[each].first_line
        line = f", line {first}" if first and len(lines[spoken[each], place]) > 1 else ""
        spoken[each] += f" ({place}{line})"
    return spoken


def _known_by(entity: EntityInfo) -> str:
    return "" if entity.name == entity.spoken_name else entity.name


def _longest(waits: Iterable[Wait], timeline: Timeline) -> WaitInRun | None:
    return max(waits_in_run(waits, timeline), key=lambda wait: wait.length, default=None)


def waits_in_run(waits: Iterable[Wait], timeline: Timeline) -> Iterator[WaitInRun]:
    """Yield those waits that are more than none, each with all its reasons: a series has one ``since``."""
    for _, each in groupby(waits, key=lambda wait: wait.since):
        series = list(each)
        ends = [wait.end_at(timeline.end) for wait in series]
        length = waited_by(max(ends), series[-1], timeline)
        shares: defaultdict[str, int] = defaultdict(int)
        for wait, end in zip(series, ends, strict=True):
            shares[why_waiting(wait, timeline)] += end - max(wait.start, max(ends) - length)
        if length >= LEAST:
            yield WaitInRun(length, max(shares, key=shares.__getitem__))


def _services(calls: Iterable[Call]) -> Iterator[ServiceFigures]:
    by_service: defaultdict[str, list[Call]] = defaultdict(list)
    for call in calls:
        by_service[call.service].append(call)
    for service, made in by_service.items():
        answered = tuple(call.replied - call.sent for call in made if call.replied is not None)
        yield ServiceFigures(service, len(made), answered)


def robot_incrementally(timeline: Timeline, window: Window) -> Incremental[RobotFigures | None]:
    """The robot's motion in a window, step by step; ``travelled`` counts from the run's start."""
    last = timeline.robot(window.end - 1)
    if last is None or last.t < window.start:
        return None
    commands = yield from collect(timeline.commands(window))
    begun = [turn.start for turn in turns_among(commands, timeline.command(window.start), window)]
    poses = [timeline.robot(at) for at in (*begun, window.end)]
    angles = [0.0 if pose is None else pose.turned for pose in poses]  # before its first pose it stands
    turned = sum(abs(after - before) for before, after in pairwise(angles))
    return RobotFigures(len(begun), turned, last.travelled, last.x, last.y, last.yaw)


def turns_among(
    commands: Iterable[VelocityCommanded], before: VelocityCommanded | None, window: Window
) -> Iterator[Window]:
    """Yield each turn among a window's commands: from one to turn to the first one not to.

    ``before`` is the command in force as the window begins.
    """
    start = window.start if before is not None and before.angular else None
    for command in commands:
        if start is None and command.angular:
            start = command.t
        elif start is not None and not command.angular:
            yield Window(start, command.t)
            start = None
    if start is not None:
        yield Window(start, window.end)


def trail_in_parts(timeline: Timeline, window: Window) -> Iterator[RobotMoved]:
    """The robot's poses in a window, queried part by part."""
    for part in split(window, window.length // _BETWEEN_POSES):
        yield from timeline.trail(part)
