"""The table of a comparison on screen, the line above it, and the lines above the lanes of each run."""

from collections.abc import Sequence

from rich.segment import Segment
from textual.geometry import Size
from textual.reactive import reactive
from textual.strip import Strip

from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.text.cells import fit
from cbtui.widgets.comparison_painter import StyledLine, headings, table
from cbtui.widgets.inked_view import InkedView
from cbtui.widgets.painted_widget import PaintedWidget, painted
from sim.trace.figures.comparison_rows import Section

_RULE = Ink(Role.FAINT)


class HeadingLine(PaintedWidget):
    """One line of texts: the first is cut if need be, of the others those that fit are shown.

    ``ruled`` draws a line from their end to the edge.
    """

    words: reactive[tuple[TextRun, ...]] = painted(())

    def __init__(self, charset: Charset, *, ruled: str = "", id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id)
        self._charset = charset
        self._ruled = ruled

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the line."""
        room = size.width
        line: list[TextRun] = []
        for text, ink in self.words:
            if len(text) <= room or not line:
                shown = fit(text, room, self._charset).rstrip() if len(text) > room else text
                line.append(TextRun(shown, ink))
                room -= len(shown)
        return [[*line, TextRun((self._ruled or " ") * room, _RULE)]]


class ComparisonHeadings(PaintedWidget):
    """Names the columns of the table, which scrolls below it."""

    def __init__(self, charset: Charset) -> None:
        super().__init__()
        self._charset = charset

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the names."""
        bar = TextRun(" " * ComparisonTable.BAR, _RULE)
        return [[*headings(size.width - ComparisonTable.BAR, self._charset), bar]]


class ComparisonTable(InkedView):
    """The figures of two runs, which scroll if there is too little room; ``show`` replaces them."""

    BAR = 1
    """Columns reserved for the scroll bar."""

    can_focus = False

    def __init__(self, charset: Charset) -> None:
        super().__init__()
        self._charset = charset
        self._sections: tuple[Section, ...] = ()
        self._lines: list[StyledLine] = []

    def show(self, sections: tuple[Section, ...]) -> None:
        """Show the sections; the scroll position stays."""
        if sections != self._sections:
            self._sections = sections
            self._paint()

    def on_resize(self) -> None:
        """Distribute the sections again."""
        self._paint()

    def render_line(self, y: int) -> Strip:
        """Return one line of the view."""
        place = self.scroll_offset.y + y
        width = self.scrollable_content_region.width
        if place >= len(self._lines):
            return Strip.blank(width, self.in_class(""))
        line = Strip([Segment(run.text, self.in_ink(run.ink)) for run in self._lines[place] if run.text])
        return line.adjust_cell_length(width, self.in_class(""))

    def _paint(self) -> None:
        width = max(0, self.size.width - self.BAR)
        self._lines = table(self._sections, width, self._charset) if self._sections else []
        self.virtual_size = Size(width, len(self._lines))
        self.refresh()
