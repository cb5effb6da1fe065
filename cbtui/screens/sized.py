"""A screen that knows which layout its terminal has room for."""

from typing import TypeVar

from textual.await_complete import AwaitComplete
from textual.events import Resize
from textual.geometry import Size
from textual.screen import ModalScreen, Screen
from textual.widgets import Static

from cbtui.screens.layout import Layout, layout_for, too_small

Result = TypeVar("Result")


class SizedScreen(Screen[Result]):
    """Carries its layout as a style class; too small a terminal gets a sentence instead of the screen."""

    layout_now = Layout.TABBED

    def on_mount(self) -> None:
        """Be laid out before the first picture."""
        self.mount(Static(classes="too-small"))
        self._lay_out(self.app.size)

    def on_resize(self, event: Resize) -> None:
        """Take the layout for the new size."""
        self._lay_out(event.size)

    def dismiss(self, result: Result | None = None) -> AwaitComplete:
        """Leave the screen. Once more while that goes on, or below another, does nothing.

        Textual takes away whatever screen is on top then.
        """
        return super().dismiss(result) if self.is_active else AwaitComplete()

    def laid_out(self) -> None:
        """Do what a screen has to do when its layout or size is another."""

    def _lay_out(self, size: Size) -> None:
        self.layout_now = layout_for(size)
        if not self.has_class(self.layout_now.value):
            for layout in Layout:
                self.set_class(layout is self.layout_now, layout.value, update=False)
            self.update_node_styles(animate=False)
        for sentence in self.query(".too-small").results(Static):
            sentence.update(too_small(size))
        self.laid_out()


class SizedModal(ModalScreen[Result], SizedScreen[Result]):
    """The same for a screen that lies over another."""
