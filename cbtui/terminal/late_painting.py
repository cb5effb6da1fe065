"""Widgets that paint when the screen is composed."""

from collections.abc import Collection, Sequence

from textual.geometry import Region
from textual.widget import Widget


class LatePaintedWidget(Widget):
    """A widget that is asked which of its cells have changed when the screen is composed.

    Textual's ``refresh`` sends a message to the widget and another to the screen, for each widget and frame;
    that took longer than most paintings. Written for Textual 8.
    """

    def changed(self) -> None:
        """Have the screen ask for the changed regions when it composes its next picture."""
        if not self.is_running or self._pruning:
            return
        screen = self.screen
        if self in screen._compositor.visible_widgets:
            screen._dirty_widgets.add(self)
            screen.check_idle()

    def changed_regions(self) -> Sequence[Region]:
        """Return the regions of the content that have changed since the last picture."""
        raise NotImplementedError

    def _exchange_repaint_regions(self) -> Collection[Region]:
        regions = () if self._pruning else self.changed_regions()
        offset = self.content_offset
        return [*super()._exchange_repaint_regions(), *(region.translate(offset) for region in regions)]
