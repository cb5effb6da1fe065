"""Private parts of Textual that the console relies on, in the version that pyproject.toml pins.

Classes that replace one of Textual's own lie beside this module: ``compositing`` (its compositor), ``driver``
and ``browser_driver`` (its drivers), ``ending`` (how its app handles faults). No module outside this room
uses a private part; ``tests/terminal/test_textual_internals.py`` checks that, and fails for each workaround
when the code of Textual that it depends on has changed: then look whether it may go.
"""

from typing import TYPE_CHECKING

from textual._styles_cache import StylesCache
from textual.app import App
from textual.await_complete import AwaitComplete
from textual.command import CommandList, CommandPalette
from textual.geometry import Size
from textual.widget import Widget

if TYPE_CHECKING:
    from textual.worker import Worker


class LeavablePalette(CommandPalette):
    """Textual's palette, safe in a low terminal and against keys and clicks after the one that closes it."""

    def dismiss(self, result: None = None) -> AwaitComplete:
        """Leave the palette; a second click beside it would take the screen below away too."""
        return super().dismiss(result) if self.is_active else AwaitComplete()

    def _gather_commands(self, search_value: str) -> "Worker[None] | None":  # type: ignore[override]
        # Keys typed after the one that closes the palette would be searched for in a list that is going away.
        return super()._gather_commands(search_value) if self.is_active else None

    def _action_command_list(self, action: str) -> None:
        # While no line of the list is visible, Textual finds no lines of the highlighted command.
        if self.query_one(CommandList).scrollable_content_region.height > 0:
            super()._action_command_list(action)


def is_mounted(app: App[None]) -> bool:
    """Whether an app has its children. Textual says so in public of a widget only."""
    return app._is_mounted


def is_being_removed(widget: Widget) -> bool:
    """Whether a widget is going away, perhaps with its screen, other widgets of which may be gone already."""
    return widget._pruning


def resize_content(widget: Widget, size: Size) -> None:
    """Set a scrollable widget's virtual size; to assign it would lay out the whole screen anew."""
    widget.set_reactive(Widget.virtual_size, size)
    widget._scroll_update(size)


def forget_drawn_styles() -> None:
    """Empty Textual's cache of a thousand pairs of colours, which keeps each widget that asked for one."""
    StylesCache.get_inner_outer.cache_clear()
