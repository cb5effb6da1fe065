"""A widget made of painted rows, of which only those that changed are sent to the terminal."""

from collections.abc import Sequence

from rich.segment import Segment
from textual.geometry import Region, Size
from textual.strip import Strip
from textual.widget import Widget

from cbtui.theme import Run, style_of


class Painted(Widget):
    """Draws the rows that ``rows`` paints. Call ``changed`` when there is something new to paint.

    However often ``changed`` is called while a message is handled, it paints once.
    """

    ALLOW_SELECT = False

    _rows: Sequence[Sequence[Run]] = ()
    _rows_size: Size | None = None
    _stale = False

    def rows(self, size: Size) -> Sequence[Sequence[Run]]:
        """Paint: return at most ``size.height`` rows, each ``size.width`` columns wide."""
        raise NotImplementedError

    def changed(self) -> None:
        """Paint anew as soon as the message at hand is dealt with."""
        if self.is_running and not self._stale:
            self._stale = True
            self.call_next(self._paint)

    def render_line(self, y: int) -> Strip:
        """Return one painted line."""
        if self._rows_size != self.size:
            self._rows, self._rows_size = self.rows(self.size), self.size
        background = self.background_colors[1].rgb
        ground = "#{:02x}{:02x}{:02x}".format(*background)
        if y >= len(self._rows):
            return Strip.blank(self.size.width, self.rich_style)
        dark = self.app.current_theme.dark
        segments = [Segment(run.text, style_of(run.ink, dark, ground)) for run in self._rows[y]]
        return Strip(segments, self.size.width)

    def _paint(self) -> None:
        self._stale = False
        before, self._rows = self._rows, self.rows(self.size)
        same_size, self._rows_size = self._rows_size == self.size, self.size
        if not same_size or len(before) != len(self._rows):
            self.refresh()
            return
        lines = [y for y, (old, new) in enumerate(zip(before, self._rows, strict=True)) if old != new]
        if lines:
            self.refresh(*(Region(0, y, self.size.width, 1) for y in lines))
