"""When a wait is over: by its timeout, by the condition of the loop around it, or as its call went on."""

import ast

from sim.diagnosis.edits.flags import event_setters
from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import SourceEditor
from sim.trace.events import Doing, Logged, ProgramAt
from sim.trace.model import Nanoseconds, Position, Window
from sim.trace.timeline import Timeline

_CLOCKS = ("time", "monotonic", "perf_counter", "time_ns", "monotonic_ns", "perf_counter_ns", "now")
"""The functions that a loop asks which lasts for some time."""


def time_limit(at: Position | ProgramAt) -> Nanoseconds:
    """Return when the timeout of a wait is over; 0 if it has none, or a loop waits again and again."""
    return at.until if not at.loop[0] or ends_by_itself(*at.loop) else 0


def goes_on(at: Position, timeline: Timeline) -> bool:
    """Return whether a call that waits in a loop, as for its next item, has gone on there before or since.

    It has if it came to another line or logged something since it first came to this one, or if another
    callback that ends its wait ran meanwhile.
    """
    if at.doing is not Doing.WAITS or not at.loop[0]:
        return False
    calls = timeline.spans_of(at.entity, Window(at.start, at.start + 1))
    begun = next((span.start for span in calls if span.thread == at.thread), at.start)
    known = timeline.positions_on(at.thread, Window(begun, timeline.end + 1))
    came = min(each.start for each in (at, *known) if (each.file, each.line) == (at.file, at.line))
    logs = timeline.logs[timeline.logs_until(came) :]
    enders, rest = event_setters(at.file, at.line), Window(came + 1, timeline.end + 1)
    return (
        any(each.start > came and (each.file, each.line) != (at.file, at.line) for each in known)
        or any(isinstance(each, Logged) and each.entity == at.entity for each in logs)
        or any(
            each.spoken_name in enders and timeline.calls_begun(each.id, rest)
            for each in timeline.entities.values()
        )
    )


@asked_of_file
def ends_by_itself(source: SourceEditor, line: int) -> bool:
    """Return whether a ``while`` compares a clock, or what it counts itself."""
    return any(_compares_what_changes(each) for each in source.nodes(ast.While) if each.lineno == line)


def _compares_what_changes(loop: ast.While) -> bool:
    compared = [
        part for each in ast.walk(loop.test) if isinstance(each, ast.Compare) for part in ast.walk(each)
    ]
    changed = {ast.unparse(each.target) for each in ast.walk(loop) if isinstance(each, ast.AugAssign)}
    return any(
        ast.unparse(each.func).rpartition(".")[2] in _CLOCKS
        if isinstance(each, ast.Call)
        else isinstance(each, ast.expr) and ast.unparse(each) in changed
        for each in compared
    )
