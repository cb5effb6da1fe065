"""The keys that leave a run: for the menu, for the run that it was opened from, or for the next lesson."""

from dataclasses import dataclass
from typing import Any

from textual.screen import Screen

from cbtui.keys.action import Scope
from cbtui.runs.live.live_run import ShownRun
from cbtui.runs.setup.changes import Changes
from cbtui.screens.console import console_of
from cbtui.screens.parts.part import ScreenPart
from cbtui.screens.parts.runs import RunController
from lessons.lesson import Lesson


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


@dataclass
class NextLesson(ScreenPart):
    """Opens the next lesson, on the clock or the ROS 2 of this one."""

    screen: Screen[Any]
    runs: RunController[ShownRun]
    following: Lesson

    def action_next_lesson(self) -> None:
        """Open it."""
        changes = Changes(real=self.runs.run.setup.real)
        console_of(self.screen).open_lesson(self.following, changes)
