"""Rows of cells to paint a factory on, with text limited to given columns."""

from collections.abc import Sequence

from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.text.cells import CellRow, fit
from cbtui.widgets.factory.glyphs import FACTORY_GLYPHS, FactoryGlyphs

PLAIN = Ink(Role.TEXT, 0)
"""Ink of text; blanks have none, so that a run of text begins at its first word."""
FAINT = Ink(Role.FAINT)
STRONG = Ink(Role.STRONG)
WARN = Ink(Role.WARN)


class Canvas:
    """``width`` x ``height`` cells; what lies outside is dropped."""

    def __init__(self, width: int, height: int, charset: Charset) -> None:
        self.charset = charset
        self.glyphs: FactoryGlyphs = FACTORY_GLYPHS[charset]
        self.width = width
        self.height = height
        self._rows = [CellRow(width, charset) for _ in range(height)]

    def put(self, column: int, line: int, glyph: str, ink: Ink) -> None:
        """Put one glyph."""
        if 0 <= line < len(self._rows):
            self._rows[line].put(column, glyph, ink)

    def fill(self, column: int, after: int, line: int, glyph: str, ink: Ink) -> None:
        """Put one glyph in the columns from ``column`` to before ``after``."""
        if 0 <= line < len(self._rows) and 0 <= column < after <= self.width:
            self._rows[line].fill(column, after, glyph, ink)

    def write(self, column: int, line: int, text: str, ink: Ink, room: int) -> int:
        """Write text, cut to ``room`` columns; return the column after it."""
        if not 0 <= line < len(self._rows) or not 0 <= column < self.width or room <= 0:
            return column
        room = min(room, self.width - column)
        shown = text if len(text) <= room else fit(text, room, self.charset).rstrip()
        self._rows[line].write(column, shown, ink)
        return column + min(room, len(text))

    def runs(self) -> Sequence[Sequence[TextRun]]:
        """Return the rows as runs of one ink each."""
        return tuple(tuple(row.runs()) for row in self._rows)
