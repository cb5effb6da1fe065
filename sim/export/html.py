"""A run as one file that plays it in any browser: lanes, log, robot, reasons; no server and no network."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from pathlib import Path

import msgspec

from sim.diagnosis import diagnose
from sim.export.bars import rows
from sim.quantities.durations import duration, timestamp
from sim.trace.descriptions import called_by, executor_label, name_of, why_waiting
from sim.trace.events import EntityId, GroupKind, Logged, Severity
from sim.trace.model import Blocked, Call, EntityInfo, GroupInfo, Nanoseconds, Span, ThreadInfo, Window
from sim.trace.timeline import Timeline

_TEMPLATE = Path(__file__).with_name("page.html")
_POSES = 6000
"""Poses of the robot that a page has at most."""
_LEVELS = {Severity.WARN: 1, Severity.ERROR: 2, Severity.FATAL: 2}

_Json = dict[str, object]


def page(timeline: Timeline) -> str:
    """The text of the file. What the program printed is data in it, and never markup."""
    data = msgspec.json.encode(_run(timeline)).decode()
    harmless = data.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
    head, title, rest = _TEMPLATE.read_text(encoding="utf-8").partition("@TITLE@")
    before, _, after = rest.partition("@RUN@")
    return f"{head}{escape(_title(timeline)) if title else ''}{before}{harmless}{after}"


def _run(timeline: Timeline) -> _Json:
    numbers = {entity: number for number, entity in enumerate(timeline.entities)}
    groups = {group: number for number, group in enumerate(timeline.groups)}
    started, arena = timeline.started, timeline.arena
    clock = f" of {started.clock} time" if started else ""
    late = f", from {timestamp(timeline.begun)} of its run on" if timeline.begun else ""
    executors = executor_label(timeline)
    lasts = duration(timeline.end - timeline.begun)
    return {
        "title": _title(timeline),
        "subtitle": f"{lasts}{clock}{late}{f', {executors}' if executors else ''}",
        "begin": _micro(timeline.begun),
        "end": _micro(timeline.end),
        "callbacks": [
            {"name": each.spoken_name, "group": groups.get(each.group, 0)}
            for each in timeline.entities.values()
        ],
        "rows": [*_rows(timeline, numbers)],
        "log": [
            (
                _micro(line.t),
                line.text.rstrip("\n"),
                _LEVELS.get(line.severity, 0) if isinstance(line, Logged) else 0,
            )
            for line in timeline.logs
        ],
        "findings": [*_findings(timeline)],
        "arena": None
        if arena is None
        else {"walls": arena.walls, "sphere": arena.sphere, "radius": arena.robot_radius},
        "robot": [*_poses(timeline)],
    }


def _title(timeline: Timeline) -> str:
    return timeline.started.target if timeline.started else "a run"


def _whole(timeline: Timeline) -> Window:
    return Window(0, timeline.end + 1)


def _micro(t: Nanoseconds) -> float:
    return t / 1000


def _micro_end(t: Nanoseconds | None) -> float | None:
    """The end of an interval; None if it was still going on when the run ended."""
    return None if t is None else _micro(t)


def _rows(timeline: Timeline, numbers: dict[EntityId, int]) -> Iterator[_Json]:
    whole = _whole(timeline)
    blocks: defaultdict[EntityId, list[Blocked]] = defaultdict(list)
    for thread in timeline.threads:
        for blocked in timeline.blocks_on(thread, whole):
            blocks[blocked.entity].append(blocked)
    for row in rows(timeline, whole):
        match row:
            case ThreadInfo():
                yield _thread(timeline, row, numbers)
            case GroupInfo():
                yield _group(timeline, row, numbers)
            case EntityInfo():
                yield _callback(timeline, row, numbers, blocks[row.id])
    calls: defaultdict[str, list[Call]] = defaultdict(list)
    for call in timeline.calls:
        calls[call.service].append(call)
    for service in timeline.services_called:
        yield {"kind": "service", "name": service, "calls": [_call(timeline, one) for one in calls[service]]}


def _thread(timeline: Timeline, thread: ThreadInfo, numbers: dict[EntityId, int]) -> _Json:
    whole = _whole(timeline)
    return {
        "kind": "thread",
        "name": thread.name,
        "spans": _spans(timeline.spans_on(thread.id, whole), numbers),
        "blocks": [_block(each, numbers) for each in timeline.blocks_on(thread.id, whole)],
    }


def _group(timeline: Timeline, group: GroupInfo, numbers: dict[EntityId, int]) -> _Json:
    whole = _whole(timeline)
    keeps = group.kind is GroupKind.EXCLUSIVE
    node = f" {timeline.nodes.get(group.node, '')}" if len(timeline.nodes) > 1 else ""
    return {
        "kind": "group",
        "name": f"{group.letter} {group.kind.value}{node}",
        "spans": _spans(timeline.spans_in(group.id, whole), numbers),
        "awaits": [
            (
                _micro(each.start),
                _micro(each.end),
                f"kept by {name_of(entity, timeline)}, which awaits",
                numbers[entity],
            )
            for entity, each in (timeline.suspensions_in(group.id, whole) if keeps else ())
        ],
    }


def _callback(
    timeline: Timeline, entity: EntityInfo, numbers: dict[EntityId, int], blocks: Sequence[Blocked]
) -> _Json:
    whole = _whole(timeline)
    return {
        "kind": "callback",
        "name": entity.spoken_name,
        "spans": _spans(timeline.spans_of(entity.id, whole), numbers, with_ages=True),
        "waits": [
            (_micro(wait.start), _micro_end(wait.end), why_waiting(wait, timeline))
            for wait in timeline.waits_of(entity.id, whole)
        ],
        "losses": [_micro(at) for at in timeline.losses_of(entity.id, whole)],
        "blocks": [_block(each, numbers) for each in blocks],
        "awaits": [
            (
                _micro(each.start),
                _micro_end(each.end if each.end <= timeline.end else None),
                "awaits",
                numbers[entity.id],
            )
            for each in timeline.suspended(entity.id, whole)
        ],
    }


def _spans(
    spans: Iterable[Span], numbers: dict[EntityId, int], *, with_ages: bool = False
) -> list[tuple[object, ...]]:
    return [
        (
            _micro(span.start),
            _micro_end(span.end),
            numbers[span.entity],
            span.error,
            f"{duration(span.age)} after it was sent or due" if with_ages and span.age else "",
        )
        for span in spans
        if span.entity in numbers
    ]


def _block(blocked: Blocked, numbers: dict[EntityId, int]) -> tuple[object, ...]:
    return _micro(blocked.start), _micro_end(blocked.end), blocked.service, numbers.get(blocked.entity)


def _call(timeline: Timeline, call: Call) -> tuple[object, ...]:
    by = called_by(call, timeline)
    return _micro(call.sent), _micro_end(call.replied), by, call.request, call.response, call.lost


def _findings(timeline: Timeline) -> Iterator[_Json]:
    for found in diagnose(timeline):
        told = found.explained(timeline)
        yield {
            "what": told.what,
            "why": told.why,
            "cure": told.cure,
            "at": _micro(found.at) if found.at or found.stuck else None,
        }


def _poses(timeline: Timeline) -> Iterator[tuple[float, ...]]:
    trail = timeline.trail(_whole(timeline))
    for place in range(0, len(trail), 1 + len(trail) // _POSES):
        pose = trail[place]
        yield _micro(pose.t), round(pose.x, 4), round(pose.y, 4), round(pose.yaw, 4)
