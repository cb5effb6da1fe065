"""Parts of a screen, and how their actions become the screen's."""

from collections.abc import Callable
from typing import Protocol

from textual.screen import Screen, ScreenResultCallbackType, ScreenResultType

from cbtui.keys.action import Scope, method_of
from cbtui.keys.actions import ACTIONS
from cbtui.looks.theme import Charset
from cbtui.screens.console import ConsoleApp, LessonOpener


class ScreenPart:
    """A part of a screen. Its methods ``action_<id>`` implement actions of the registry."""

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Tell whether one of its actions is available now."""
        return True


class WindowHost(Protocol):
    """A screen that opens windows."""

    @property
    def charset(self) -> Charset:
        """What the terminal can show."""

    def ask(
        self, question: Screen[ScreenResultType], take: ScreenResultCallbackType[ScreenResultType] | None
    ) -> None:
        """Open a screen over this one; ``take`` gets its result."""


class DrawnHost(Protocol):
    """Something that shows a run and can be redrawn."""

    def redraw(self) -> None:
        """Draw everything soon."""


class RunHost(DrawnHost, Protocol):
    """Something that shows a run and sentences about it."""

    @property
    def console(self) -> LessonOpener:
        """What opens lessons."""

    def tell(self, sentence: str | None) -> None:
        """Show a sentence for a few seconds; nothing for None."""

    def key(self, action: str) -> str:
        """Return the key in force of one of a lesson's actions, for display."""


class ScreenHost(WindowHost, RunHost, Protocol):
    """A screen as its parts see it."""

    @property
    def console(self) -> ConsoleApp:
        """The app; available once the screen is shown."""

    def tell(self, sentence: str | None, holds: Callable[[], bool] | None = None) -> None:
        """Show a sentence for a few seconds, and no longer than it ``holds``; nothing for None."""


class ScreenParts:
    """The actions of a screen: those of its parts, its own methods ``action_<id>``, and more by id."""

    def __init__(
        self, screen: object, scope: Scope, *parts: ScreenPart, **more: Callable[[], object]
    ) -> None:
        self._homes: dict[str, ScreenPart] = {}
        for part in parts:
            for name in dir(part):
                if name.startswith("action_"):
                    self._homes[name.removeprefix("action_")] = part
                    setattr(screen, name, getattr(part, name))  # Textual looks up actions on the screen
        for action, do in more.items():
            setattr(screen, f"action_{action}", do)
        names = {method_of(action)[0] for action in ACTIONS if action.scope is scope}
        self._absent = {name for name in names if not hasattr(screen, f"action_{name}")}

    def has(self, action: str) -> bool:
        """Tell whether the screen implements an action."""
        return action not in self._absent

    def offer(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Tell whether an action is available now; actions of other nodes always are."""
        home = self._homes.get(action)
        return self.has(action) if home is None else home.offers(action, parameters)
