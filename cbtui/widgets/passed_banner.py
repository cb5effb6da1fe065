"""The banner over the lanes when an exercise passes for the first time."""

from collections.abc import Sequence

from textual.geometry import Size
from textual.reactive import reactive

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun
from cbtui.text.cells import CellRow
from cbtui.widgets.painted_widget import PaintedWidget, painted

_FRAME = 1 / 20
_FRAMES = 40
_STAYS = 12.0
"""Seconds for which it is shown."""


class PassedBanner(PaintedWidget):
    """Lanes that fill from the left until all run at once, and a text on them; hidden until ``celebrate``."""

    place: reactive[int] = painted(0)
    """The number of past frames."""

    def __init__(self, charset: Charset) -> None:
        super().__init__()
        self._text = ""
        self._charset = charset
        self.display = False

    def celebrate(self, text: str) -> None:
        """Show a text for ``_STAYS`` seconds."""
        self._text = text
        self.display = True
        if self.app.animation_level == "none":
            self.place = _FRAMES
        else:
            self.set_interval(_FRAME, self._go_on, repeat=_FRAMES)
        self.set_timer(_STAYS, self.on_click)

    def on_click(self) -> None:
        """Hide."""
        self.display = False

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the lanes."""
        return banner(self._text, size, self.place / _FRAMES, self._charset)

    def _go_on(self) -> None:
        self.place += 1


def banner(text: str, size: Size, share: float, charset: Charset) -> list[list[TextRun]]:
    """Return the banner after a share (0 to 1) of its movement."""
    glyphs, rows = GLYPHS[charset], [CellRow(size.width, charset) for _ in range(size.height)]
    if not rows:
        return []
    middle = size.height // 2
    for number, row in enumerate(rows):
        length = round(min(1.0, share * (1.6 - 0.6 * number / max(1, size.height - 1))) * size.width)
        row.fill(0, length, glyphs.left[8], Ink(Role.BAR, number))
    start = max(0, (size.width - len(text)) // 2 - 1)
    rows[middle].write(start, f" {text} ", Ink(Role.STRONG))
    return [row.runs() for row in rows]
