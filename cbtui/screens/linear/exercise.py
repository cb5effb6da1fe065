"""A lesson's exercise in lines: the file is made, and checked as often as is asked."""

from dataclasses import dataclass
from pathlib import Path
from threading import Thread

from cbtui.learning.exercise_files import CannotPlaceError, StarterPlacement, own_file, place_starter
from cbtui.runs.judged.check_text import checked_text
from cbtui.runs.judged.checking import CheckedFile, check
from cbtui.screens.linear.asking import PostingHost
from cbtui.screens.parts.part import ScreenPart
from lessons.judge import Judge
from lessons.lesson import BadLesson, Lesson
from lessons.progress import Progress


@dataclass
class ExerciseInLines(ScreenPart):
    """Tells the task and makes the file; a changed file is run out of sight and checked."""

    host: PostingHost
    lesson: Lesson
    progress: Progress

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer what the exercise has, its hints and solution once the lesson is explained."""
        exercise, known = self.lesson.exercise, self.progress.of(self.lesson.id)
        if exercise is None:
            return False
        left = action != "hint" or known.hints < len(exercise.hints)
        return action == "exercise" or (known.seen and left)

    def action_exercise(self) -> None:
        """Tell the exercise and make its file, or check the file as it is."""
        assert self.lesson.exercise is not None
        key = self.host.key("exercise")
        try:
            placed = place_starter(self.lesson, Path().absolute())
            file = own_file(self.lesson, Path().absolute()).path
            judge = Judge(self.lesson)
        except FileNotFoundError:
            self.host.tell("The current folder is gone; start the console in another one.")
        except (CannotPlaceError, BadLesson) as error:
            self.host.tell(str(error))
        else:
            if placed is StarterPlacement.CHANGED:
                self.host.tell(f"{file.name} is run and checked in the background.")
                Thread(target=lambda: self._check(judge, file), name="check", daemon=True).start()
            else:
                self.host.tell_page(self.lesson.exercise.asks)
                self.host.tell(f"Edit {file}; {key} checks it then.")

    def _check(self, judge: Judge, file: Path) -> None:
        checked = check(self.lesson, judge, file)
        self.host.post(lambda: self._tell(checked))

    def _tell(self, checked: CheckedFile) -> None:
        self.host.tell(checked.run.trouble)
        for line in checked_text(checked).splitlines():
            self.host.tell(line)
        if checked.good:
            self.progress.passes(self.lesson.id)
            self.host.tell("The exercise is solved.")

    def action_hint(self) -> None:
        """Tell the next hint."""
        assert self.lesson.exercise is not None
        number = self.progress.of(self.lesson.id).hints + 1
        self.progress.take_hint(self.lesson.id, number)
        self.host.tell_page(self.lesson.exercise.hints[number - 1])
