"""A compositor that asks only those widgets to draw that have something new to show."""

from collections.abc import Iterable

from textual._compositor import ChopsUpdate, Compositor
from textual.geometry import Region
from textual.strip import Strip


class SparingCompositor(Compositor):
    """Puts a partial picture together from the widgets that lie where it changes.

    Textual's own asks every widget for every line between the first and the last that change, the quiet ones
    too: on a screen of many panes that costs more than what is new. What overlaps a change, such as a message
    that lies over it, is asked as before. Of Textual 8; a test holds it to the same picture.
    """

    _changes: tuple[Region, ...] | None = None

    def render_partial_update(self) -> ChopsUpdate | None:
        """Return what changed; None if nothing did."""
        self._changes = tuple(self._dirty_regions)
        try:
            return super().render_partial_update()
        finally:
            self._changes = None

    def _get_renders(self, crop: Region | None = None) -> Iterable[tuple[Region, Region, list[Strip]]]:
        if self._changes is None:
            yield from super()._get_renders(crop)
            return
        for widget, (region, clip) in self.visible_widgets.items():
            shown = region.intersection(clip)
            changed = [shown.intersection(change) for change in self._changes if shown.overlaps(change)]
            if changed:
                first = min(part.y for part in changed)
                lines = max(part.bottom for part in changed) - first
                part = Region(shown.x, first, shown.width, lines)
                yield region, part, widget.render_lines(part.translate(-region.offset))
