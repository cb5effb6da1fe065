"""Holds back keys and clicks until the screen they are meant for is mounted; drops an enter meant for none.

Textual sends keys to a screen as soon as it is on the stack. Until its widgets have mounted their children,
an action finds only some of them, and removing the screen leaves the others without theirs.
"""

import asyncio
from collections.abc import Callable
from functools import partial
from time import monotonic

from textual.app import App
from textual.errors import NoWidget
from textual.events import Event, InputEvent, Key, MouseDown
from textual.widget import Widget

from cbtui.terminal.key_turns import KeyHandled, KeyTurns
from cbtui.terminal.textual_internals import is_mounted

MOUNT_TIMEOUT = 3.0
"""Seconds to wait for widgets to be mounted."""
ENTER_AFTER = 5.0
"""Seconds in which people press the enter that was not needed any more."""
IDLE = 2.0
"""Seconds without input after which nobody is taken to be typing."""
_POLL_INTERVAL = 0.005
"""Seconds between two checks."""


class PendingKeysApp(App[None]):
    """An app that handles input once the screen is mounted, and ignores clicks on removed widgets."""

    _input_at = 0.0
    """When the last input came."""
    _enter_until = 0.0
    """Until when, as events count time, a first key is ignored if it is enter."""

    def __init__(self) -> None:
        super().__init__()
        self._key_turns = KeyTurns(self, self._handle)

    def ignore_enter(self) -> None:
        """Ignore an enter that comes as the next key and soon: what it would confirm was done without it."""
        self._enter_until = monotonic() + ENTER_AFTER

    def when_idle(self, do: Callable[[], object]) -> None:
        """Call what would hold up a key as soon as nothing was typed or clicked for ``IDLE`` seconds."""
        left = self._input_at + IDLE - monotonic()
        if left > 0:
            self.set_timer(left, partial(self.when_idle, do))
        else:
            do()

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
        """Handle an event; input waits until the screen is mounted, a key for the one before."""
        if isinstance(event, Key):  # also one that comes back from a screen that is no longer current
            until, self._enter_until = self._enter_until, 0.0
            if event.key == "enter" and event.time < until:
                return
        if isinstance(event, InputEvent):
            self._input_at = monotonic()
        if isinstance(event, Key) and not event.is_forwarded:
            await self._key_turns.take(event)
        else:
            await self._handle(event)

    async def _handle(self, event: Event) -> None:
        if isinstance(event, InputEvent):
            deadline = monotonic() + MOUNT_TIMEOUT
            while self.is_mounting and monotonic() < deadline:
                await asyncio.sleep(_POLL_INTERVAL)
            if not self.screen_stack:  # the app ends
                return
        if not (isinstance(event, MouseDown) and self._is_gone(event)):
            await super().on_event(event)

    def on_app_key_handled(self, event: KeyHandled) -> None:
        """Let the next key take its turn."""
        self._key_turns.handled(event.turn)

    def _is_gone(self, click: MouseDown) -> bool:
        """Whether the clicked widget was removed and is still drawn; Textual would look for its parent."""
        try:
            widget, _ = self.get_widget_at(click.x, click.y)
        except NoWidget:
            return False
        return not widget.is_attached
