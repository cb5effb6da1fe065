"""The menu's banner: the name, and a picture of lanes."""

from collections.abc import Sequence

from textual.geometry import Size

from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.text.cells import CellRow
from cbtui.widgets.painted_widget import PaintedWidget

_TITLES = ("cbtui", "Callback groups and executors,", "live. No ROS 2 needed.")
_TITLE_WIDTH = 34
_BARS = ((5, 31), (44, 49), (58, 63), (72, 98))
_STEPS = (6, 6)


class Banner(PaintedWidget):
    """Three lanes: one long callback, and two that run beside it."""

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the three rows."""
        return banner(size.width)


def banner(width: int) -> list[list[TextRun]]:
    """Return the head, three rows of ``width`` columns."""
    rows = [CellRow(width, Charset.BRAILLE) for _ in range(3)]
    for number, (row, title) in enumerate(zip(rows, _TITLES, strict=True)):
        row.write(2, title, Ink(Role.FAINT if number else Role.STRONG))
        row.write(_TITLE_WIDTH, "ABC"[number], Ink(Role.LETTER, number))
    lanes = range(_TITLE_WIDTH + 2, width - 2)
    for start, end in _BARS:
        _bar(rows[0], [column for column in lanes if start <= column - lanes.start < end])
    for number, row in enumerate(rows[1:], start=1):
        for column in lanes[number * 2 :: _STEPS[number - 1]]:
            row.put(column, "▌" if number == 1 else "▐", Ink(Role.BAR, number))
    return [row.runs() for row in rows]


def _bar(row: CellRow, columns: Sequence[int]) -> None:
    """Draw a callback of the first group; a long one carries its name."""
    if not columns:
        return
    row.fill(columns[0], columns[-1] + 1, "█", Ink(Role.BAR, 0))
    name = "timer_callback"
    if len(columns) > len(name) + 4:
        row.write(columns[0] + 2, f" {name} ", Ink(Role.LABEL, 0))
