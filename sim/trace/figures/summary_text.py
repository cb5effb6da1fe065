"""A summary as plain text for a terminal: aligned columns, 79 characters wide where names allow."""

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace

from sim.quantities.durations import duration
from sim.quantities.plural import counted
from sim.trace.descriptions import nothing_came
from sim.trace.figures.summary import CallbackFigures, RobotFigures, ServiceFigures, Summary, without_waits

HEADS = ("callback", "group", "calls", "running", "late by", "lost", "errors")
_MANY = 5
"""From so many callbacks on that are alike but for their figures, they have one row."""
LATE_BY = "late by: its oldest message, taken or waiting, or how late its timer was"
NOT_KNOWN = "lost -: real ROS 2 does not tell what became of messages that never came"


def plain_text(summary: Summary) -> str:
    """The whole summary, ending in a newline, without empty parts."""
    callbacks = list(_together(summary.callbacks))
    parts = [
        list(_heading(summary)),
        list(_callback_table(callbacks)),
        list(_waits(callbacks)),
        list(_rest(summary)),
    ]
    return "\n".join("\n".join([*part, ""]) for part in parts if part)


def _heading(summary: Summary) -> Iterator[str]:
    clock = f" of {summary.clock} time" if summary.clock else ""
    ending = f": {summary.ending}" if summary.ending else ""
    yield f"{summary.target or 'run'}, {duration(summary.length)}{clock}{ending}"
    if summary.lost:
        yield f"The trace lost {summary.lost} events, so some figures below are too small."


def _together(callbacks: Sequence[CallbackFigures]) -> Iterator[CallbackFigures]:
    """Yield the figures of each callback, and those of many that are alike as one's."""
    alike = defaultdict[object, list[CallbackFigures]](list)
    for each in callbacks:
        alike[each.name, each.group, each.entity.kind, each.entity.period].append(each)
    for same in alike.values():
        if len(same) < _MANY:
            yield from same
            continue
        waits = (each.longest_wait for each in same if each.longest_wait is not None)
        yield replace(
            same[0],
            name=f"{same[0].name} × {len(same)}",
            calls=sum(each.calls for each in same),
            running=sum(each.running for each in same),
            longest_wait=max(waits, key=lambda wait: wait.length, default=None),
            late=max(each.late for each in same),
            drops=sum(each.drops or 0 for each in same)
            or (None if None in {each.drops for each in same} else 0),
            errors=sum(each.errors for each in same),
        )


def _callback_table(callbacks: Sequence[CallbackFigures]) -> Iterator[str]:
    if not callbacks:
        return
    rows = [HEADS, *(_cells(figures) for figures in callbacks)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for name, group, *figures in rows:
        right = (cell.rjust(width) for cell, width in zip(figures, widths[2:], strict=True))
        yield "  ".join((name.ljust(widths[0]), group.ljust(widths[1]), *right))
    yield LATE_BY
    if any(each.drops is None for each in callbacks):
        yield NOT_KNOWN


def _cells(figures: CallbackFigures) -> tuple[str, ...]:
    return (
        figures.name,
        figures.group,
        str(figures.calls),
        f"{figures.running:.1%}",
        duration(figures.late) if figures.calls or figures.late else "-",
        "-" if figures.drops is None or not figures.entity.depth else str(figures.drops),
        str(figures.errors),
    )


def _waits(callbacks: Sequence[CallbackFigures]) -> Iterator[str]:
    waited = [(figures.name, figures.longest_wait) for figures in callbacks if figures.longest_wait]
    if not callbacks:
        return
    if not waited:
        yield f"longest waits: {without_waits(callbacks)}"
        return
    yield "longest waits"
    widest = max(len(name) for name, _ in waited)
    for name, wait in waited:
        yield f"  {name.ljust(widest)}  {duration(wait.length)}: {wait.why}"


def _rest(summary: Summary) -> Iterator[str]:
    yield f"threads  {summary.threads_used} ran callbacks, at most {summary.threads_at_once} at once"
    label = "calls"
    for service in summary.services:
        yield f"{label:<7}  {service_line(service)}"
        label = ""
    for told in summary.raised_at_end:
        yield f"its end  {told}"
    if summary.is_short:
        yield "nodes    none was made by then: let it run for longer, if it makes some"
    if silent := nothing_came(summary.silent):
        yield f"topics   {silent}"
    if summary.robot:
        yield f"robot    {robot_line(summary.robot)}"


def service_line(figures: ServiceFigures) -> str:
    """The calls of a service as text: ``/motor_power  2 calls, answered after 5.0 s``."""
    trips = figures.round_trips
    if not trips:
        return f"{figures.service}  {counted(figures.calls, 'call')}, no reply"
    shortest, longest = duration(min(trips)), duration(max(trips))
    span = shortest if shortest == longest else f"{shortest} to {longest}"
    answered = "answered" if len(trips) == figures.calls else f"{len(trips)} answered"
    return f"{figures.service}  {counted(figures.calls, 'call')}, {answered} after {span}"


def robot_line(figures: RobotFigures) -> str:
    """The robot's motion as text: ``2 turns (3.1 rad), 0.85 m travelled, at x 0.85 y 0.00 heading 0°``."""
    turns = counted(figures.turns, "turn") + (f" ({figures.turned:.1f} rad)" if figures.turns else "")
    x, y, heading = _rounded(figures.x, 2), _rounded(figures.y, 2), _rounded(math.degrees(figures.yaw), 0)
    pose = f"at x {x:.2f} y {y:.2f} heading {heading:.0f}°"
    return f"{turns}, {figures.travelled:.2f} m travelled, {pose}"


def _rounded(value: float, places: int) -> float:
    """Rounded, without negative zero."""
    return round(value, places) + 0.0
