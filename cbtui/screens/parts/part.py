"""What a part of a screen is, and how a screen comes to the actions of its parts."""

from collections.abc import Callable
from typing import Any, Protocol

from textual.screen import Screen, ScreenResultCallbackType, ScreenResultType

from cbtui.keys.action import Scope, method_of
from cbtui.keys.actions import ACTIONS
from cbtui.looks.theme import Charset
from cbtui.screens.console import Console


class ScreenPart:
    """A part of a screen. Its methods ``action_<id>`` do what the registry's actions are on that screen."""

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Tell whether one of its actions has a meaning now."""
        return True


class DialogHost(Protocol):
    """A screen that asks questions."""

    @property
    def charset(self) -> Charset:
        """What the terminal can show."""

    def ask(
        self,
        question: Screen[ScreenResultType],
        take: ScreenResultCallbackType[ScreenResultType] | None,
    ) -> None:
        """Lay another screen over this one; ``take`` gets what it comes to."""


class ScreenHost(DialogHost, Protocol):
    """A screen as its parts see it."""

    @property
    def console(self) -> Console:
        """The app; only once the screen is shown."""

    def tell(self, sentence: str | None) -> None:
        """Show a sentence for a few seconds; nothing for None."""

    def redraw(self) -> None:
        """Draw everything soon: more has changed than that the run has gone on."""

    def key(self, action: str) -> str:
        """Return the key in force of one of a lesson's actions, as people write it."""


class ScreenParts:
    """The actions of a screen: those of its parts, its own methods ``action_<id>``, and more by their ids."""

    def __init__(
        self, screen: Screen[Any], scope: Scope, *parts: ScreenPart, **more: Callable[[], object]
    ) -> None:
        self._homes: dict[str, ScreenPart] = {}
        for part in parts:
            for name in dir(part):
                if name.startswith("action_"):
                    self._homes[name.removeprefix("action_")] = part
                    setattr(screen, name, getattr(part, name))  # Textual looks for it there
        for action, do in more.items():
            setattr(screen, f"action_{action}", do)
        names = {method_of(action)[0] for action in ACTIONS if action.scope is scope}
        self._absent = {name for name in names if not hasattr(screen, f"action_{name}")}

    def has(self, action: str) -> bool:
        """Tell whether an action of the screen's scope is one of the screen's."""
        return action not in self._absent

    def offer(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Tell whether an action has a meaning now; one that is not the screen's own affair always has."""
        home = self._homes.get(action)
        return self.has(action) if home is None else home.offers(action, parameters)
