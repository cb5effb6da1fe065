"""Screens whose layout depends on the terminal's size."""

from typing import TypeVar

from textual.await_complete import AwaitComplete
from textual.events import Resize
from textual.geometry import Size
from textual.screen import ModalScreen, Screen, ScreenResultCallbackType, ScreenResultType
from textual.widgets import Static

from cbtui.screens.layout import Layout, layout_for, too_small
from cbtui.terminal.textual_internals import clear_hints
from cbtui.widgets.key_bar import say_at_once

Result = TypeVar("Result")


class SizedScreen(Screen[Result]):
    """Sets its layout as a style class; in a terminal that is too small it shows a sentence."""

    layout_now = Layout.TABBED

    def on_mount(self) -> None:
        """Set the layout before the first drawing."""
        self.mount(Static(classes="too-small"))
        self._lay_out(self.app.size)

    def on_resize(self, event: Resize) -> None:
        """Set the layout for the new size."""
        self._lay_out(event.size)

    @property
    def is_current(self) -> bool:
        """Whether the screen can be seen.

        Textual also counts one beneath an opaque screen, and draws that one anew whenever this one changes.
        """
        return super().is_current and (self.is_active or self.app.screen.styles.background.a < 1)

    def dismiss(self, result: Result | None = None) -> AwaitComplete:
        """Leave the screen; does nothing unless it is active.

        Textual would remove whatever screen is on top.
        """
        return super().dismiss(result) if self.is_active else AwaitComplete()

    def ask(
        self, question: Screen[ScreenResultType], take: ScreenResultCallbackType[ScreenResultType] | None
    ) -> None:
        """Lay another screen over this one, and no hint over that; ``take`` gets its result."""
        clear_hints(self.app)
        if not isinstance(question, ModalScreen):
            say_at_once(self, "opening …")
        self.app.push_screen(question, take)

    def laid_out(self) -> None:
        """Hook that is called when the layout or size has changed."""

    def _lay_out(self, size: Size) -> None:
        self.layout_now = layout_for(size)
        if not self.has_class(self.layout_now.value):
            for layout in Layout:
                self.set_class(layout is self.layout_now, layout.value, update=False)
            self.update_node_styles(animate=False)
        for sentence in self.query(".too-small").results(Static):
            sentence.update(too_small(size))
        self.laid_out()
