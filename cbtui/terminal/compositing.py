"""A compositor that draws and sends only the cells that changed."""

from collections.abc import Iterable, Sequence
from itertools import groupby, pairwise
from typing import NamedTuple

from rich.console import Console, ConsoleOptions, RenderResult
from rich.control import Control
from textual._compositor import Compositor, CompositorUpdate, ReflowResult
from textual.geometry import Region, Size
from textual.strip import Strip
from textual.widget import Widget


class ScreenPatch(NamedTuple):
    """New content for some columns of one screen line."""

    x: int
    y: int
    strip: Strip


class PatchUpdate(CompositorUpdate):
    """A screen update that consists of patches."""

    def __init__(self, parts: Sequence[ScreenPatch]) -> None:
        self.parts = parts

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the segments for the terminal."""
        for x, y, strip in self.parts:
            yield Control.move_to(x, y).segment
            yield from strip

    def render_segments(self, console: Console) -> str:
        """Return the text for the terminal with its escape sequences."""
        return "".join(
            sequence
            for x, y, strip in self.parts
            for sequence in (Control.move_to(x, y).segment.text, strip.render(console))
        )


class _VisibleWidget(NamedTuple):
    """A widget, its region, and the visible part of that region."""

    widget: Widget
    region: Region
    sight: Region


class _LineSegment(NamedTuple):
    """Neighbouring columns of a line in which one widget is in front."""

    shown: _VisibleWidget
    y: int
    start: int
    end: int

    @property
    def line(self) -> int:
        """The number of the widget's own line."""
        return self.y - self.shown.region.y


class PatchCompositor(Compositor):
    """Composes a partial update from the widgets in the changed regions alone.

    Textual's own compositor renders every line of every widget between the first and the last changed line,
    and sends lines from the widget's left edge on. With many panes that costs more than the change itself.
    Written for Textual 8; a test compares both pictures.
    """

    def __init__(self) -> None:
        super().__init__()
        self._arranged = self._full_map
        """The last layout that was drawn."""
        self._layout: object = None
        """The layout for which the widgets in front are cached."""
        self._visible: list[_VisibleWidget] = []
        self._fronts: dict[tuple[int, int], _VisibleWidget] = {}

    def clear(self) -> None:
        """Remove all references to widgets."""
        super().clear()
        self._arranged = self._full_map
        self._layout = None
        self._visible.clear()
        self._fronts.clear()

    def reflow(self, parent: Widget, size: Size) -> ReflowResult:
        """Arrange the widgets, and return what differs from the layout that was arranged before.

        Textual compares with what ``full_map`` has. If anything has looked at the new layout already, it
        finds no difference: nothing is drawn anew, and no widget hears that it is shown or of another size.
        """
        self._full_map = self._arranged
        found = super().reflow(parent, size)
        self._arranged = self._full_map
        return found

    def render_partial_update(self) -> PatchUpdate | None:  # type: ignore[override]  # an update of another kind
        """Return the changed part of the screen; None if nothing changed."""
        changed = self._dirty_regions.copy()
        self._dirty_regions.clear()
        if not changed:
            return None
        screen = self.size.region
        spans = self._regions_to_spans(region.intersection(screen) for region in changed)
        return PatchUpdate(_drawn([stretch for span in spans for stretch in self._stretches(span)]))

    def _stretches(self, span: tuple[int, int, int]) -> list[_LineSegment]:
        """Divide part of a line among the widgets in front."""
        y, start, end = span
        stretches: list[_LineSegment] = []
        for left, right in pairwise([start, *(cut for cut in self.cuts[y] if start < cut < end), end]):
            shown = self._front(left, y)
            if stretches and stretches[-1].shown is shown:
                stretches[-1] = stretches[-1]._replace(end=right)
            else:
                stretches.append(_LineSegment(shown, y, left, right))
        return stretches

    def _front(self, x: int, y: int) -> _VisibleWidget:
        """Return the foremost widget at a cell."""
        layout = self.visible_widgets  # another object for each layout, the foremost first
        if layout is not self._layout:
            self._layout, self._fronts = layout, {}
            self._visible = [
                _VisibleWidget(widget, region, region.intersection(clip))
                for widget, (region, clip) in layout.items()
            ]
        if (x, y) not in self._fronts:
            self._fronts[x, y] = next(shown for shown in self._visible if shown.sight.contains(x, y))
        return self._fronts[x, y]


def _drawn(stretches: Iterable[_LineSegment]) -> list[ScreenPatch]:
    """Render the wanted lines of each widget, those that follow each other at once."""
    wanted: dict[Widget, list[_LineSegment]] = {}
    for stretch in stretches:
        wanted.setdefault(stretch.shown.widget, []).append(stretch)
    parts = []
    for widget, its in wanted.items():
        region, strips = its[0].shown.region, dict[int, Strip]()
        places = enumerate(dict.fromkeys(each.line for each in its))
        for _, neighbours in groupby(places, lambda each: each[1] - each[0]):
            lines = [line for _, line in neighbours]
            drawn = widget.render_lines(Region(0, lines[0], region.width, len(lines)))
            strips.update(zip(lines, drawn, strict=True))
        for each in its:
            strip = strips[each.line].crop(each.start - region.x, each.end - region.x)
            parts.append(ScreenPatch(each.start, each.y, strip))
    return parts
