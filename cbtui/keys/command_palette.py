"""The registry's actions in the command palette."""

from collections.abc import Coroutine, Iterator
from functools import partial
from typing import Any

from textual.command import DiscoveryHit, Hit, Hits, Provider

from cbtui.keys.action import KeyAction, Scope, method_of
from cbtui.keys.actions import actions_of
from cbtui.keys.bindings import perform
from cbtui.keys.keymap import keymap_of
from cbtui.keys.signs import signs_of
from cbtui.looks.theme import Charset


class ActionsProvider(Provider):
    """Offers the actions that are available on the screen below the palette."""

    async def discover(self) -> Hits:
        """Offer all of them."""
        for action in self._actions():
            yield DiscoveryHit(action.help, self._run(action))

    async def search(self, query: str) -> Hits:
        """Offer those whose help or label matches."""
        matcher = self.matcher(query)
        for action in self._actions():
            score = max(matcher.match(action.help), matcher.match(action.label))
            if score > 0:
                keys = signs_of([action], Charset.ASCII)
                yield Hit(score, matcher.highlight(action.help), self._run(action), help=f"key {keys}")

    def _actions(self) -> Iterator[KeyAction]:
        scope: Scope | None = getattr(self.screen, "SCOPE", None)
        if scope is None:
            return
        for action in keymap_of(self.app).of(actions_of(scope)):
            if action.id == "command_palette" or action.refused:
                continue
            if self.screen.check_action(*method_of(action)) is not False:
                yield action

    def _run(self, action: KeyAction) -> "partial[Coroutine[Any, Any, None]]":
        return partial(perform, self.app, action)
