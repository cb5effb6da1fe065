"""What helps with an exercise: its hints, one by one, and its solution."""

from pathlib import Path

from cbtui.keys.keymap import keymap_of
from cbtui.keys.named_keys import with_keys_in_force
from cbtui.learning.lesson_page import Part
from cbtui.screens.lesson.teaching import TeachingScreen
from cbtui.widgets.guide import Guide
from lessons.description import Exercise
from sim.foreign_file import MOST_OF_A_PROGRAM, read_text

_READING = 15.0
"""Seconds that a hint stays which is told over another pane than the guide."""


class HelpingScreen(TeachingScreen):
    """Gives hints and shows the solution, once the exercise can be read."""

    @property
    def _open_exercise(self) -> Exercise | None:
        """The exercise, if it can be read: beside it, or when its lesson was watched."""
        lesson, standing = self.lesson, self._standing
        if lesson is None or standing is None:
            return None
        return lesson.exercise if self._at_exercise or standing.progress.seen else None

    @property
    def _not_to_be_learnt(self) -> dict[str, bool]:
        exercise, standing = self._open_exercise, self._standing
        taken = 0 if standing is None else standing.progress.hints
        return super()._not_to_be_learnt | {
            "hint": exercise is None or taken >= len(exercise.hints),
            "solution": exercise is None,
        }

    async def action_hint(self) -> None:
        """Take the next hint: it is added to the page, and told where the page is not in sight."""
        lesson, exercise = self.lesson, self._open_exercise
        if lesson is None or exercise is None:
            return
        number = self._progress.of(lesson.id).hints + 1
        if number > len(exercise.hints):
            return
        self._progress.take_hint(lesson.id, number)
        await self._learnt()
        guide = self.query_one(Guide)
        if guide.display:
            guide.go_to(Part.HINTS)
        else:
            title = f"Hint {number} of {len(exercise.hints)}"
            hint = with_keys_in_force(exercise.hints[number - 1], keymap_of(self.app))
            self.notify(hint, title=title, timeout=_READING, markup=False)

    def action_solution(self) -> None:
        """Show the solution; the first time, ask whether that is wanted."""
        from cbtui.screens.solution import AskingScreen  # with Pygments

        lesson, exercise = self.lesson, self._open_exercise
        if lesson is None or exercise is None:
            return
        progress = self._progress.of(lesson.id)
        if progress.solution:
            self._show_solution(True)
        else:
            left = len(exercise.hints) - progress.hints
            self.app.push_screen(AskingScreen(left, self._charset), self._show_solution)

    def _show_solution(self, wanted: bool | None) -> None:
        from cbtui.screens.solution import SolutionScreen

        lesson = self.lesson
        if not wanted or lesson is None or lesson.solution_path is None or lesson.starter_path is None:
            return
        self._progress.look_at_solution(lesson.id)
        begun = self._subject.node_path if self._at_exercise else lesson.starter_path
        texts = [(path.name, _text_in(path)) for path in (begun, lesson.solution_path)]
        self.app.push_screen(SolutionScreen(texts[0], texts[1], self._charset))


def _text_in(path: Path) -> str:
    """The text of a file; of one that is gone or no text, as much as there is."""
    try:
        return read_text(path, MOST_OF_A_PROGRAM, "replace")
    except OSError:
        return ""
