"""Keys and clicks wait for the screen that they are meant for.

Textual hands a key to a screen as soon as it is on the stack. Until its widgets have their children, whatever
the key does finds only some of them; and one that takes the screen away again leaves those without any.
"""

import asyncio
from time import monotonic

from textual.app import App
from textual.errors import NoWidget
from textual.events import Event, InputEvent, MouseDown
from textual.widget import Widget

from cbtui.terminal.textual_internals import is_mounted

MOUNT_TIMEOUT = 3.0
"""Seconds that widgets may take to be mounted; then nothing waits for them any more."""
_POLL_INTERVAL = 0.005
"""Seconds after which it is looked again."""


class PatientApp(App[None]):
    """An app whose keys and clicks take effect when the screen is whole, and not on what is gone."""

    @property
    def is_mounting(self) -> bool:
        """Whether any widget that is there still has to get its children."""
        if not is_mounted(self):
            return self.is_running
        screens = self.screen_stack
        return not all(
            node.is_mounted for screen in screens for node in [screen, *screen.walk_children(Widget)]
        )

    async def on_event(self, event: Event) -> None:
        """Deal with an event; with what a person did, when the screen is whole."""
        if isinstance(event, InputEvent):
            patient_until = monotonic() + MOUNT_TIMEOUT
            while self.is_mounting and monotonic() < patient_until:
                await asyncio.sleep(_POLL_INTERVAL)
        if not (isinstance(event, MouseDown) and self._is_gone(event)):
            await super().on_event(event)

    def _is_gone(self, click: MouseDown) -> bool:
        """Whether what is clicked on was removed, and is only still drawn; Textual asks for its parent."""
        try:
            widget, _ = self.get_widget_at(click.x, click.y)
        except NoWidget:
            return False
        return not widget.is_attached
