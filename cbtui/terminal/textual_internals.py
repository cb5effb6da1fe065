"""Private parts of Textual that the console relies on, in the version that pyproject.toml pins.

Classes that replace Textual's own are in this package: ``compositing`` (its compositor), ``driver`` and
``browser_driver`` (its drivers), ``ending`` (fault handling of its app). No other package uses a private
part; ``tests/terminal/test_textual_internals.py`` checks that, and fails for a workaround when the Textual
code that it depends on changes: then check whether the workaround can be removed.
"""

from time import time
from typing import TYPE_CHECKING, Any

from textual._styles_cache import StylesCache
from textual.app import App
from textual.await_complete import AwaitComplete
from textual.command import CommandList, CommandPalette
from textual.content import Content
from textual.geometry import Region, Size
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import OptionList
from textual.widgets._toast import ToastHolder, ToastRack

if TYPE_CHECKING:
    from textual.worker import Worker

_READ = 1.0
"""Seconds after which a sentence that lies over the screen is taken to be read by who types on."""


class SafeCommandPalette(CommandPalette):
    """Textual's palette without its faults in low terminals and with input after the closing key."""

    def dismiss(self, result: None = None) -> AwaitComplete:
        """Close the palette; a second click beside it would close the screen below as well."""
        return super().dismiss(result) if self.is_active else AwaitComplete()

    def _gather_commands(self, search_value: str) -> "Worker[None] | None":  # type: ignore[override]
        # Keys typed after the closing one would start a search in a list that is being removed.
        return super()._gather_commands(search_value) if self.is_active else None

    def _action_command_list(self, action: str) -> None:
        # Textual fails to find the highlighted line while no line of the list is visible.
        if self.query_one(CommandList).scrollable_content_region.height > 0:
            super()._action_command_list(action)


def is_mounted(app: App[None]) -> bool:
    """Whether an app has mounted its children; Textual's public property exists for widgets only."""
    return app._is_mounted


def is_being_removed(widget: Widget) -> bool:
    """Whether a widget is being removed, perhaps with its whole screen."""
    return widget._pruning


def clear_hints(app: App[Any]) -> None:
    """Take away the sentences that lie over the screen, unless one of them warns."""
    if all(each.severity == "information" for each in app._notifications):
        app.clear_notifications()
    _remove_holders(app)


def clear_read(app: App[Any]) -> None:
    """Take away the sentences that have lain over the screen for ``_READ``; not warnings and long ones."""
    for each in list(app._notifications):
        is_short = each.severity == "information" and each.timeout <= app.NOTIFICATION_TIMEOUT
        if is_short and time() - each.raised_at > _READ:
            app._unnotify(each)
    _remove_holders(app)


def take_back(app: App[Any], sentence: str) -> None:
    """Take away a sentence that lies over the screen."""
    for each in list(app._notifications):
        if each.message == sentence:
            app._unnotify(each)
    _remove_holders(app)


def make_room_for(app: App[Any], sentence: str) -> None:
    """Clear a sentence's own notification, which would end its repetition, and all but one that informs."""
    others = [each for each in app._notifications if each.message != sentence]
    informing = [each for each in others if each.severity == "information"]
    for each in list(app._notifications):
        if each not in others or each in informing[:-1]:
            app._unnotify(each)
    _remove_holders(app)


def _remove_holders(app: App[Any]) -> None:
    """Remove the holders of notifications that are gone: Textual leaves them, each a row high."""
    kept = {ToastRack._toast_id(each) for each in app._notifications}
    for screen in app.screen_stack[-1:]:  # there is none as an app ends
        for holder in screen.query(ToastHolder):
            if holder.id not in kept:
                holder.remove()


def paint_now(widget: Widget) -> None:
    """Send a widget's picture to the terminal before what takes long in the same message."""
    screen = widget.screen
    screen._compositor.update_widgets({widget})
    screen.app._display(screen, screen._compositor.render_update())


def update_now(screen: Screen[None]) -> None:
    """Send what has changed to the terminal now; Textual waits for its next sixtieth of a second.

    A new layout is left to Textual, as it takes long, and there may be several in a row; and so are callbacks
    that wait for it.
    """
    waits = screen._layout_required or screen._scroll_required or screen.app._batch_count
    if screen.is_current and not waits:
        screen._compositor.update_widgets(screen._dirty_widgets)
        screen._compositor_refresh()


def first_lines(options: OptionList) -> list[tuple[int, int]]:
    """Return the row and the index of each option whose first line is in view; some take more lines."""
    top = round(options.scroll_offset.y)
    shown = options._lines[top : top + options.size.height]
    return [(row, index) for row, (index, line) in enumerate(shown) if line == 0]


def resize_content(widget: Widget, size: Size) -> None:
    """Set a scrollable widget's virtual size; assigning it would lay out the whole screen again."""
    widget.set_reactive(Widget.virtual_size, size)
    widget._scroll_update(size)


def set_title(widget: Widget, title: str) -> None:
    """Set the title in a widget's frame and draw that line; assigning it would draw the whole widget."""
    if widget._border_title != title:
        widget._border_title = Content(title)
        _refresh_frame(widget, 0)


def set_subtitle(widget: Widget, title: str) -> None:
    """Set the title in the lower line of a widget's frame likewise."""
    if widget._border_subtitle != title:
        widget._border_subtitle = Content(title)
        _refresh_frame(widget, widget.outer_size.height - 1)


def _refresh_frame(widget: Widget, line: int) -> None:
    left, top = widget.gutter.top_left
    widget.refresh(Region(-left, line - top, widget.outer_size.width, 1))


def forget_drawn_styles() -> None:
    """Clear Textual's cache of a thousand pairs of colours, which keeps widgets alive."""
    StylesCache.get_inner_outer.cache_clear()
