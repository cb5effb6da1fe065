"""A run as one file that plays it in any browser: lanes, log, robot, reasons; no server and no network."""

from collections.abc import Iterator
from html import escape
from pathlib import Path

import msgspec

from sim.diagnosis import diagnose
from sim.export.bars import rows
from sim.quantities.durations import duration
from sim.trace.descriptions import executor_label, why_waiting
from sim.trace.events import Logged, Severity
from sim.trace.model import EntityInfo, GroupInfo, Nanoseconds, ThreadInfo, Window
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
    executors = executor_label(timeline)
    lasts = duration(timeline.end - timeline.begun)
    return {
        "title": _title(timeline),
        "subtitle": f"{lasts}{clock}{f', {executors}' if executors else ''}",
        "begin": _micro(timeline.begun),
        "end": _micro(timeline.end),
        "callbacks": [
            {"name": each.spoken_name, "group": groups.get(each.group, 0)}
            for each in timeline.entities.values()
        ],
        "rows": [_row(timeline, row, numbers) for row in rows(timeline, _whole(timeline))],
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


def _row(timeline: Timeline, row: ThreadInfo | GroupInfo | EntityInfo, numbers: dict[int, int]) -> _Json:
    whole, end = _whole(timeline), timeline.end
    if isinstance(row, ThreadInfo):
        name, kind, spans = row.name, "thread", timeline.spans_on(row.id, whole)
    elif isinstance(row, GroupInfo):
        name, kind, spans = f"{row.letter} {row.kind.value}", "group", timeline.spans_in(row.id, whole)
    else:
        name, kind, spans = row.spoken_name, "callback", timeline.spans_of(row.id, whole)
    is_callback = isinstance(row, EntityInfo)
    return {
        "name": name,
        "kind": kind,
        "spans": [
            (
                _micro(span.start),
                _micro(span.end_at(end)),
                numbers[span.entity],
                span.error,
                f"{duration(span.age)} after it was sent or due" if is_callback and span.age else "",
            )
            for span in spans
            if span.entity in numbers
        ],
        "waits": [
            (_micro(wait.start), _micro(wait.end_at(end)), why_waiting(wait, timeline))
            for wait in (timeline.waits_of(row.id, whole) if is_callback else ())
        ],
        "losses": [_micro(at) for at in (timeline.losses_of(row.id, whole) if is_callback else ())],
    }


def _findings(timeline: Timeline) -> Iterator[_Json]:
    for found in diagnose(timeline):
        told = found.explained(timeline)
        yield {"what": told.what, "why": told.why, "cure": told.cure, "at": _micro(found.at)}


def _poses(timeline: Timeline) -> Iterator[tuple[float, ...]]:
    trail = timeline.trail(_whole(timeline))
    for place in range(0, len(trail), 1 + len(trail) // _POSES):
        pose = trail[place]
        yield _micro(pose.t), round(pose.x, 4), round(pose.y, 4), round(pose.yaw, 4)
