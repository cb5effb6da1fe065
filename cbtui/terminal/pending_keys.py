"""Holds back keys and clicks until the screen that they are meant for is mounted.

Textual sends keys to a screen as soon as it is on the stack. Until its widgets have mounted their children,
an action finds only some of them, and removing the screen leaves the others without theirs.
"""

import asyncio
from time import monotonic

from textual.app import App
from textual.errors import NoWidget
from textual.events import Event, InputEvent, MouseDown
from textual.widget import Widget

from cbtui.terminal.textual_internals import is_mounted

MOUNT_TIMEOUT = 3.0
"""Seconds to wait for widgets to be mounted."""
_POLL_INTERVAL = 0.005
"""Seconds between two checks."""


class PendingKeysApp(App[None]):
    """An app that handles input once the screen is mounted, and ignores clicks on removed widgets."""

    @property
    def is_mounting(self) -> bool:
        """Whether any widget has yet to mount its children."""
        if not is_mounted(self):
            return self.is_running
        screens = self.screen_stack
        return not all(
            node.is_mounted for screen in screens for node in [screen, *screen.walk_children(Widget)]
        )

    async def on_event(self, event: Event) -> None:
        """Handle an event; input waits until the screen is mounted."""
        if isinstance(event, InputEvent):
            deadline = monotonic() + MOUNT_TIMEOUT
            while self.is_mounting and monotonic() < deadline:
                await asyncio.sleep(_POLL_INTERVAL)
        if not (isinstance(event, MouseDown) and self._is_gone(event)):
            await super().on_event(event)

    def _is_gone(self, click: MouseDown) -> bool:
        """Whether the clicked widget was removed and is still drawn; Textual would look for its parent."""
        try:
            widget, _ = self.get_widget_at(click.x, click.y)
        except NoWidget:
            return False
        return not widget.is_attached
