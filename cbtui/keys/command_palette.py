"""The command palette, and the registry's actions in it."""

from collections.abc import Coroutine, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

from textual.await_complete import AwaitComplete
from textual.command import CommandList, CommandPalette, DiscoveryHit, Hit, Hits, Provider

from cbtui.keys.actions import Action, Scope, actions_of, method_of, perform, signs_of
from cbtui.keys.keymap import keymap_of
from cbtui.looks.theme import Charset

if TYPE_CHECKING:
    from textual.worker import Worker


class Palette(CommandPalette):
    """Textual's palette, for the hasty."""

    def dismiss(self, result: None = None) -> AwaitComplete:
        """Leave the palette; a second click beside it would take the screen below away too."""
        return super().dismiss(result) if self.is_active else AwaitComplete()

    def _gather_commands(self, search_value: str) -> "Worker[None] | None":  # type: ignore[override]
        # What is typed behind the key that closes it would be looked for in a list that goes away meanwhile.
        return super()._gather_commands(search_value) if self.is_active else None

    def _action_command_list(self, action: str) -> None:
        # Where nothing of the list is shown yet, Textual finds no lines of the highlighted command.
        if self.query_one(CommandList).scrollable_content_region.height > 0:
            super()._action_command_list(action)


class ActionsProvider(Provider):
    """Offers the actions that work on the screen below the palette."""

    async def discover(self) -> Hits:
        """Offer all of them."""
        for action in self._actions():
            yield DiscoveryHit(action.help, self._run(action))

    async def search(self, query: str) -> Hits:
        """Offer those whose help or label fits."""
        matcher = self.matcher(query)
        for action in self._actions():
            score = max(matcher.match(action.help), matcher.match(action.label))
            if score > 0:
                keys = signs_of([action], Charset.ASCII)
                yield Hit(score, matcher.highlight(action.help), self._run(action), help=f"key {keys}")

    def _actions(self) -> Iterator[Action]:
        scope: Scope | None = getattr(self.screen, "SCOPE", None)
        if scope is None:
            return
        for action in keymap_of(self.app).of(actions_of(scope)):
            if action.id != "command_palette" and self.screen.check_action(*method_of(action)) is not False:
                yield action

    def _run(self, action: Action) -> "partial[Coroutine[Any, Any, None]]":
        return partial(perform, self.app, action)
