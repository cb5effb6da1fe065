"""Lets keys take effect one after another, however fast they come.

Textual sends a key at once to what has the focus, though what the key before does there may move the focus.
Of ``/text`` that comes in one go, as over ssh, the letters would act as keys of the pane.
"""

import asyncio
from collections import deque
from collections.abc import Awaitable, Callable, Iterable
from typing import Any

from textual.app import App
from textual.events import Key
from textual.message import Message
from textual.message_pump import MessagePump

PATIENCE = 0.5
"""Seconds after which the next key is handled if the widget of the last one has gone: its end is unknown."""
_BUSY_POLLS = 6
"""So many times ``PATIENCE`` a widget that is still there may take for a key."""


class KeyHandled(Message, namespace="app"):
    """Bubbles up behind a key, so it comes to the app when the key has been handled."""

    def __init__(self, turn: int) -> None:
        super().__init__()
        self.turn = turn


class KeyTurns:
    """Hands one key at a time to ``handle``, the next when the focus is as the last one left it."""

    def __init__(self, app: App[Any], handle: Callable[[Key], Awaitable[None]]) -> None:
        self._app = app
        self._handle = handle
        self._held: deque[Key] = deque()
        self._turn = 0
        self._is_free = True

    async def take(self, key: Key) -> None:
        """Handle a key, now or in its turn."""
        self._held.extend(_apart(key))
        if self._is_free:
            await self._next(self._turn)

    def handled(self, turn: int) -> None:
        """The key of a turn has been handled: the next one follows behind what that has left to be done."""
        screens = self._app.screen_stack
        if not (screens and screens[-1].call_later(self._app.call_later, self._next, turn)):
            self._app.call_later(self._next, turn)

    async def _next(self, turn: int) -> None:
        if turn != self._turn:  # its time was up
            return
        self._turn += 1
        self._is_free = not self._held
        if self._held:
            await self._handle(self._held.popleft())
            if not self._app.screen_stack:  # the app ends
                return
            target = self._app.focused or self._app.screen
            if target.post_message(KeyHandled(self._turn)):
                self._wait(target, self._turn, _BUSY_POLLS)
            else:
                self._app.call_later(self._next, self._turn)

    def _wait(self, target: MessagePump, turn: int, polls: int) -> None:
        """Begin the next turn after a while, unless the key of this one is handled before."""
        if turn != self._turn:
            return
        if polls and target.is_running:
            asyncio.get_running_loop().call_later(PATIENCE, self._wait, target, turn, polls - 1)
        else:
            self._app.call_later(self._next, turn)


def _apart(key: Key) -> Iterable[Key]:
    """Return escape and a letter that came at once as two keys, and enter for a line feed.

    Terminals send the same for the letter with the Alt key, which no key here has. Enter is a line feed if it
    was typed while the terminal was still the shell's.
    """
    if key.key == "ctrl+j":
        return [Key("enter", "\r")]
    if not key.key.startswith("alt+") or key.character is None:
        return [key]
    return [Key("escape", None), Key(key.character, key.character)]
