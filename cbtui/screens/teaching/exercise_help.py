"""The keys for an exercise's hints and solution."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from textual.screen import Screen

from cbtui.keys.keymap import keymap_of
from cbtui.keys.named_keys import with_keys_in_force
from cbtui.learning.lesson_page import PageSection, PageState
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.teaching.learning import Learning
from lessons.description import Exercise
from sim.files.untrusted import program_text

_READING = 15.0
"""Seconds for which a hint is shown as a notification."""


@dataclass
class ExerciseHelp(ScreenPart):
    """Gives hints and shows the solution, once the exercise is unlocked.

    ``is_readable`` tells whether it is unlocked, ``is_done`` whether it is solved; ``file`` is the learner's,
    None before the exercise was begun.
    """

    screen: Screen[None]
    host: ScreenHost
    learning: Learning
    file: Path | None
    is_readable: Callable[[PageState], bool]
    is_done: Callable[[], bool] = lambda: False

    @property
    def _exercise(self) -> Exercise | None:
        """The exercise, if it is unlocked."""
        state = self.learning.state
        return self.learning.lesson.exercise if state is not None and self.is_readable(state) else None

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the hints that are left, and the solution always."""
        exercise, state = self._exercise, self.learning.state
        if exercise is None or state is None:
            return False
        return action == "solution" or (state.progress.hints < len(exercise.hints) and not self.is_done())

    async def action_hint(self) -> None:
        """Take the next hint: it is added to the page, and shown as a notification if the page is hidden."""
        exercise, learning = self._exercise, self.learning
        if exercise is None:
            return
        number = learning.progress.hints + 1
        if number > len(exercise.hints):
            return
        learning.store.take_hint(self.learning.lesson.id, number)
        await learning.update_page()
        if learning.guide.display:
            learning.guide.go_to(PageSection.HINTS)
        else:
            title = f"Hint {number} of {len(exercise.hints)}"
            hint = with_keys_in_force(exercise.hints[number - 1], keymap_of(self.screen.app))
            self.screen.app.clear_notifications()  # earlier hints are on the page
            self.screen.notify(hint, title=title, timeout=_READING, markup=False)

    def action_solution(self) -> None:
        """Show the solution, after a confirmation the first time if the exercise is not solved."""
        from cbtui.screens.windows.solution import ConfirmSolutionScreen  # with Pygments

        exercise, progress = self._exercise, self.learning.progress
        if exercise is None:
            return
        if progress.solution or self.is_done():
            self._show_solution(True)
        else:
            left = len(exercise.hints) - progress.hints
            self.host.ask(ConfirmSolutionScreen(left, self.host.charset), self._show_solution)

    def _show_solution(self, wanted: bool | None) -> None:
        from cbtui.screens.windows.solution import SolutionScreen

        lesson = self.learning.lesson
        begun = self.file or lesson.starter_path
        if not wanted or lesson.solution_path is None or begun is None:
            return
        self.learning.store.look_at_solution(lesson.id)
        texts = [(path.name, program_text(path) or "") for path in (begun, lesson.solution_path)]
        self.host.ask(SolutionScreen(texts[0], texts[1], self.host.charset), None)
