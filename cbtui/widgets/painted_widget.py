"""A widget of painted rows, of which only the changed cells are sent to the terminal."""

from collections.abc import Callable, Sequence
from itertools import takewhile
from typing import Any, TypeVar

from rich.cells import cell_len
from rich.segment import Segment
from rich.style import Style
from textual.color import Color
from textual.filter import ANSIToTruecolor
from textual.geometry import Region, Size
from textual.reactive import reactive
from textual.strip import Strip

from cbtui.looks.colour_themes import palette_of
from cbtui.looks.theme import Ink, TextRun, style_of
from cbtui.terminal.late_painting import LatePaintedWidget
from cbtui.text.cells import BLANK

ValueT = TypeVar("ValueT")


def painted(default: ValueT | Callable[[], ValueT], *, always_update: bool = False) -> reactive[ValueT]:
    """Return a reactive attribute of a painted widget: setting another value paints the widget anew.

    With ``always_update`` setting the same value does so too.
    """
    return _PaintedAttribute(default, always_update)


class _PaintedAttribute(reactive[ValueT]):
    def __init__(self, default: ValueT | Callable[[], ValueT], always_update: bool) -> None:
        super().__init__(default, repaint=False, always_update=always_update)
        self._paints_always = always_update

    def __set__(self, widget: Any, value: ValueT) -> None:
        if self._paints_always or getattr(widget, self.name) != value:
            super().__set__(widget, value)
            widget.changed()


class PaintedWidget(LatePaintedWidget):
    """Draws the rows that ``rows`` paints. ``changed`` has it paint anew.

    However often ``changed`` is called before the screen's next picture, it paints once.
    """

    ALLOW_SELECT = False

    _rows: Sequence[Sequence[TextRun]] = ()
    _rows_size: Size | None = None
    _stale = False
    _background: Color | None = None
    """The cached background colour."""
    _sides: tuple[list[Segment], list[Segment]] | None = None
    """The cached frame and padding at the left and right of the painted lines."""

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id)
        self._styles: dict[Ink, Style] = {}

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint: return at most ``size.height`` rows, each ``size.width`` columns wide."""
        raise NotImplementedError

    def changed(self) -> None:
        """Paint again for the screen's next picture."""
        self._stale = True
        super().changed()

    def show_rows(self, rows: Sequence[Sequence[TextRun]]) -> None:
        """Show rows that come from elsewhere, until it paints again."""
        self._rows, self._rows_size, self._stale = rows, self.size, False
        self.refresh()

    def changed_regions(self) -> Sequence[Region]:
        """Paint if that is due, and return the regions that differ from the last picture."""
        if not self._stale:
            return ()
        before, size = self._rows, self._rows_size
        self._paint()
        if size != self._rows_size or len(before) != len(self._rows):
            return (self.size.region,)
        return [
            Region(start, y, end - start, 1)
            for y, (old, new) in enumerate(zip(before, self._rows, strict=True))
            for start, end in [changed_part(old, new)]
            if start < end
        ]

    def render_lines(self, crop: Region) -> list[Strip]:
        """Return lines of the widget, its frame included.

        Textual's own method handles features that no painted widget uses, such as tints, and takes longer
        than the painting. No ink has a colour of the terminal's own that would have to be converted.
        """
        size = self.size
        top, rows, width = self.gutter.top, size.height, self.outer_size.width
        background = self._background_now()
        filters = [each for each in self.get_line_filters() if not isinstance(each, ANSIToTruecolor)]
        self._paint_for(size)
        lines: list[Strip] = []
        for y in crop.line_range:
            if top <= y < top + rows:
                left, right = self._sides_of(y)
                segments = self.segments(y - top)
                for each in filters:
                    segments = each.apply(segments, background)
                lines.append(Strip([*left, *segments, *right], width))
            else:
                lines += super().render_lines(Region(0, y, width, 1))
        return [line.crop(crop.x, crop.right) for line in lines]

    def render_line(self, y: int) -> Strip:
        """Return one painted line."""
        size = self.size
        self._paint_for(size)
        return Strip(self.segments(y), size.width)

    def segments(self, y: int) -> list[Segment]:
        """Return one line of what was painted last, as wide as the rows are."""
        if y >= len(self._rows):
            return [Segment(" " * self.size.width, self._style(BLANK))]
        return [Segment(run.text, self._style(run.ink)) for run in self._rows[y]]

    def notify_style_update(self) -> None:
        """Discard the cached background and frame of the previous theme."""
        super().notify_style_update()
        self._styles.clear()
        self._background = self._sides = None

    def _background_now(self) -> Color:
        if self._background is None:
            self._background = self.background_colors[1]
        return self._background

    def _paint_for(self, size: Size) -> None:
        """Paint, unless what was painted is up to date and of this size."""
        if self._stale or self._rows_size != size:
            self._paint()

    def _style(self, ink: Ink) -> Style:
        if ink not in self._styles:
            ground = "#{:02x}{:02x}{:02x}".format(*self._background_now().rgb)
            self._styles[ink] = style_of(ink, palette_of(self.app.current_theme), ground)
        return self._styles[ink]

    def _sides_of(self, y: int) -> tuple[list[Segment], list[Segment]]:
        """The frame and padding left and right of the widget's line ``y``."""
        if self._sides is None:
            line = super().render_lines(Region(0, y, self.outer_size.width, 1))[0]
            left = self.gutter.left
            self._sides = list(line.crop(0, left)), list(line.crop(left + self.size.width))
        return self._sides

    def _paint(self) -> None:
        """Paint, whether that is due or not."""
        self._stale = False
        self._rows_size = self.size
        self._rows = self.rows(self._rows_size)


def changed_part(before: Sequence[TextRun], after: Sequence[TextRun]) -> tuple[int, int]:
    """Return the columns from the first to the last different run; both rows have the same width."""
    if before == after:
        return 0, 0
    first, last = _same(before, after), _same(before[::-1], after[::-1])
    start = _width(after[:first])
    return start, start + _width(after[first : len(after) - last])


def _same(before: Sequence[TextRun], after: Sequence[TextRun]) -> int:
    """The number of runs with which both rows begin."""
    return len([*takewhile(lambda pair: pair[0] == pair[1], zip(before, after, strict=False))])


def _width(runs: Sequence[TextRun]) -> int:
    return sum([cell_len(run.text) for run in runs])
