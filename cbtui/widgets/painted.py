"""A widget made of painted rows, of which only what changed is sent to the terminal."""

from collections.abc import Sequence
from itertools import takewhile

from rich.cells import cell_len
from rich.segment import Segment
from textual.geometry import Region, Size
from textual.strip import Strip
from textual.widget import Widget

from cbtui.colour_themes import palette_of
from cbtui.palettes import Palette
from cbtui.theme import Run, style_of


class Painted(Widget):
    """Draws the rows that ``rows`` paints. Call ``changed`` when there is something new to paint.

    However often ``changed`` is called while a message is handled, it paints once.
    """

    ALLOW_SELECT = False

    _rows: Sequence[Sequence[Run]] = ()
    _rows_size: Size | None = None
    _stale = False
    _look: tuple[Palette, str] | None = None
    """The theme's palette, and the colour behind the text, as long as the styles do not change."""

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
        size = self.size
        if self._rows_size != size:
            self._rows, self._rows_size = self.rows(size), size
        if y >= len(self._rows):
            return Strip.blank(size.width, self.rich_style)
        if self._look is None:
            background = self.background_colors[1].rgb
            self._look = palette_of(self.app.current_theme), "#{:02x}{:02x}{:02x}".format(*background)
        segments = [Segment(run.text, style_of(run.ink, *self._look)) for run in self._rows[y]]
        return Strip(segments, size.width)

    def notify_style_update(self) -> None:
        """Forget the look of the theme before."""
        super().notify_style_update()
        self._look = None

    def _paint(self) -> None:
        self._stale = False
        before, self._rows = self._rows, self.rows(self.size)
        same_size, self._rows_size = self._rows_size == self.size, self.size
        if not same_size or len(before) != len(self._rows):
            self.refresh()
            return
        regions = [
            Region(start, y, end - start, 1)
            for y, (old, new) in enumerate(zip(before, self._rows, strict=True))
            for start, end in [changed_part(old, new)]
            if start < end
        ]
        if regions:
            self.refresh(*regions)


def changed_part(before: Sequence[Run], after: Sequence[Run]) -> tuple[int, int]:
    """Return the columns from the first run that differs to the end of the last; both rows are as wide."""
    if before == after:
        return 0, 0
    start = _same(before, after)
    width = sum(cell_len(run.text) for run in after)
    return start, width - _same(before[::-1], after[::-1])


def _same(before: Sequence[Run], after: Sequence[Run]) -> int:
    """How many columns the runs have that both rows begin with."""
    pairs = takewhile(lambda pair: pair[0] == pair[1], zip(before, after, strict=False))
    return sum(cell_len(run.text) for run, _ in pairs)
