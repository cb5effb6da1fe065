"""The narrator: shows the executor's decisions at a moment, and their reasons."""

from collections.abc import Sequence

from textual.geometry import Size
from textual.reactive import reactive

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun
from cbtui.text.cells import MOST_COLUMNS, fit, lines_of_text
from cbtui.widgets.narrator.narration import decisions_at, narration
from cbtui.widgets.painted_widget import PaintedWidget, painted
from sim.quantities.durations import timestamp
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

ROWS = 4
"""The number of rows at first; they become more where there is room, but not fewer from event to event."""
_FIRST = Ink(Role.STRONG)
_NEXT = Ink(Role.TEXT)


class Narrator(PaintedWidget):
    """Shows the executor's last decision up to the moment ``now``."""

    timeline: reactive[Timeline] = painted(Timeline, always_update=True)
    now: reactive[Nanoseconds] = painted(0)
    stepped: reactive[bool] = painted(False)
    """Whether a step led to the moment, so that it is told even if nothing was decided then."""
    place: reactive[int | None] = painted(None)
    """Which of the decisions of one moment is looked at, from 0; None for the newest."""
    charset: reactive[Charset] = painted(Charset.BRAILLE)
    _wanted = ROWS

    def on_hide(self) -> None:
        """Begin with few rows again."""
        self._wanted = ROWS

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Return the most rows that a moment has taken so far."""
        return self._wanted

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the sentences, each on as many rows as it takes; on wider ones if they do not fit else.

        Where they still do not fit, those before the decision looked at go first.
        """
        width = max(20, size.width)
        told = list(narration(self.timeline, self.now, self.stepped))
        newest = decisions_at(self.timeline, self.now, self.stepped) - 1
        here = newest if self.place is None else self.place
        if here < newest:
            told[here] += " (panes show the end of this moment)"
        lines = self._lines(told, 0, here, width - 6, MOST_COLUMNS)
        if len(lines) > size.height > 0:
            lines = self._lines(told, 0, here, width - 6, width)
        if len(lines) > max(size.height, self._wanted) and self.is_running:
            self.call_later(self._grow, len(lines))
        for first in range(1, here + 1):
            if len(lines) > size.height > 0:
                lines = self._lines(told, first, here, width - 6, width)
        if len(lines) > size.height > 0:
            last, ink = lines[size.height - 1]
            lines[size.height - 1 :] = [(f"{last} {GLYPHS[self.charset].ellipsis}", ink)]
        return [[TextRun(fit(line, width, self.charset), ink)] for line, ink in lines]

    def _grow(self, rows: int) -> None:
        self._wanted = max(self._wanted, rows)
        self.refresh(layout=True)

    def _lines(
        self, told: Sequence[str], first: int, here: int, width: int, most: int
    ) -> list[tuple[str, Ink]]:
        lines: list[tuple[str, Ink]] = []
        decided = self.timeline.neighbour(self.now + 1, -1) or self.now
        for place, text in enumerate(told[first:], first):
            when = f"{timestamp(decided)}, decision {place + 1}: " if place == first > 0 else ""
            sign = f" {GLYPHS[self.charset].forth} " if place == here else "   "
            for line in lines_of_text(when + text, width, self.charset, most):
                lines.append((f"{sign}{line}", _FIRST if place == here else _NEXT))
                sign = "     "
        return lines
