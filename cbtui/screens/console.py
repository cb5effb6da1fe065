"""The interface of the app that screens use."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, cast

if TYPE_CHECKING:
    from collections.abc import Coroutine

    from textual.screen import Screen

    from cbtui.learning.outcome import Observe
    from cbtui.runs.setup.changes import Changes
    from cbtui.runs.setup.recent import RecentEntry
    from lessons.lesson import Lesson
    from lessons.progress import Progress
    from lessons.puzzles import Puzzle
    from sim.engine.setup import RealRos


class LessonOpener(Protocol):
    """What opens lessons, and knows how far the learner is."""

    progress: Progress
    """The learner's progress."""

    def open_lesson(self, lesson: Lesson, changes: Changes | None = None, *, tour: bool = False) -> None:
        """Run a lesson on screen, in place of another that may be open, as it is or with changes.

        With ``tour`` it is shown round first.
        """


class ConsoleApp(LessonOpener, Protocol):
    """The app as its screens see it."""

    observe: Observe
    """Runs a lesson in the background, to find the true answers to its predictions."""

    def open_lesson(
        self, lesson: Lesson, changes: Changes | None = None, *, tour: bool = False, over: bool = False
    ) -> None:
        """Run a lesson; with ``over`` the screen stays, and is come back to."""

    def open_exercise(self, lesson: Lesson, real: RealRos | None = None) -> None:
        """Run and check the learner's file for a lesson's exercise, on the model or on that ROS 2."""

    def open_puzzle(self, puzzle: Puzzle) -> None:
        """Let the learner schedule the threads of a puzzle."""

    def open_file(self, entry: RecentEntry) -> None:
        """Run a program or show a recording.

        Raises:
            CannotOpenError: it is not there, or nothing that can be opened.
        """

    def ignore_enter(self) -> None:
        """Ignore an enter that comes as the next key and soon: what it would confirm was done without it."""

    def tell_saved(self, sentence: str) -> None:
        """Report what was saved as a screen closed."""

    def collect_later(self) -> None:
        """Have what a closed screen leaves in memory collected once nobody types."""

    def end_later(self, ending: Coroutine[None, None, None]) -> None:
        """End in the background what a closed screen leaves."""


def console_of(screen: Screen[Any]) -> ConsoleApp:
    """Return the console that shows a screen."""
    return cast("ConsoleApp", screen.app)
