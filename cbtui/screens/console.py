"""What screens ask of the console that shows them."""

from typing import Any, Protocol, cast

from textual.screen import Screen

from cbtui.learning.outcome import Observe
from cbtui.runs.setup.recent import RecentEntry
from lessons.lesson import Lesson
from lessons.progress import Progress


class Console(Protocol):
    """The application, as far as its screens know it."""

    progress: Progress
    """How far the learner has come."""
    observe: Observe
    """Runs a lesson in the background, to tell which answers of its predictions are true."""

    def open_lesson(self, lesson: Lesson) -> None:
        """Run a lesson on screen, in place of another that may be open."""

    def open_exercise(self, lesson: Lesson) -> None:
        """Run and check the learner's file for a lesson's exercise."""

    def open_file(self, entry: RecentEntry) -> None:
        """Run a program or show a recording.

        Raises:
            CannotOpenError: it is not there, or nothing that can be opened.
        """

    def tell_saved(self, sentence: str) -> None:
        """Say what was saved when a screen was left."""


def console_of(screen: Screen[Any]) -> Console:
    """Return the console that shows a screen."""
    return cast("Console", screen.app)
