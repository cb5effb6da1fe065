"""The key that leaves a run: for the menu, or for the run that it was opened from."""

from dataclasses import dataclass
from typing import Any

from textual.screen import Screen

from cbtui.keys.action import Scope
from cbtui.screens.parts.part import ScreenPart


@dataclass
class WaysBack(ScreenPart):
    """Leaves the screen of a run."""

    screen: Screen[Any]

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the one that says where it leads."""
        stack = self.screen.app.screen_stack
        below = stack[: stack.index(self.screen)] if self.screen in stack else []
        covers_run = bool(below) and getattr(below[-1], "SCOPE", None) is Scope.LESSON
        return covers_run is (action == "go_back")

    def action_leave(self) -> None:
        """Go back to the menu."""
        self.screen.dismiss()

    def action_go_back(self) -> None:
        """Go back to the run below."""
        self.screen.dismiss()
