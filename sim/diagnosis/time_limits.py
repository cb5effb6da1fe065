"""When a wait is over whatever happens: by its timeout, or by the condition of the loop around it."""

import ast

from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import SourceEditor
from sim.trace.events import ProgramAt
from sim.trace.model import Nanoseconds, Position

_CLOCKS = ("time", "monotonic", "perf_counter", "time_ns", "monotonic_ns", "perf_counter_ns", "now")
"""The functions that a loop asks which lasts for some time."""


def time_limit(at: Position | ProgramAt) -> Nanoseconds:
    """Return when the timeout of a wait is over; 0 if it has none, or a loop waits again and again."""
    return at.until if not at.loop[0] or ends_by_itself(*at.loop) else 0


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
