"""The time axis below the lanes: seconds, the cursor, and the person's commands."""

from collections.abc import Iterable

from cbtui.looks.theme import GLYPHS, Ink, Role
from cbtui.text.cells import CellRow
from cbtui.widgets.lanes.scale import TimeScale, labels
from sim.trace.model import AxisMark, AxisMarkKind, Call

_FAINT = Ink(Role.FAINT)
_NOW = Ink(Role.NOW)
_MARK = Ink(Role.MARK)


def draw_axis(
    row: CellRow,
    scale: TimeScale,
    cursor: int,
    name: str,
    marks: Iterable[AxisMark],
    calls: Iterable[Call],
) -> None:
    """Draw an axis, with the person's commands except the calls that a service's lane shows.

    ``cursor`` is the cursor's column, which may lie outside the picture; ``name`` is what it is called.
    """
    _draw_cursor(row, cursor, name)
    shown = {scale.column_of(call.sent) for call in calls}
    commands = (mark for mark in marks if mark.kind is AxisMarkKind.COMMAND)
    _draw_commands(row, scale, (each for each in commands if scale.column_of(each.at) not in shown))
    for column, text in labels(scale):
        if row.blank(max(column - 1, 0), column + len(text) + 1):
            row.write(column, text, _FAINT)


def _draw_cursor(row: CellRow, column: int, name: str) -> None:
    """Mark the cursor, or the side of the picture on which it lies."""
    glyphs = GLYPHS[row.charset]
    last, length = len(row.cells) - 1, len(name)
    if column < 0:
        row.write(0, f"{glyphs.back}{name} ", _NOW)
    elif column > last:
        row.write(max(0, last - length - 1), f" {name}{glyphs.forth}", _NOW)
    elif column >= length:
        row.write(column - length, f"{name}{glyphs.now}", _NOW)
    else:
        row.write(column, f"{glyphs.now}{name} ", _NOW)


def _draw_commands(row: CellRow, scale: TimeScale, commands: Iterable[AxisMark]) -> None:
    """Mark the person's commands, with their text where it fits."""
    up = GLYPHS[row.charset].up
    marks = {scale.column_of(mark.at): mark for mark in commands}
    for column in marks:
        if row.inks[column] is not _NOW:
            row.put(column, up, _MARK)
    for column, mark in marks.items():
        if row.inks[column] is _MARK and row.blank(column + 1, column + len(mark.text) + 2):
            row.write(column + 1, mark.text, _MARK)
