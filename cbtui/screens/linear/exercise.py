"""A lesson's exercise in lines: creates the file, and checks it on request."""

from collections.abc import Iterator
from dataclasses import dataclass
from difflib import SequenceMatcher
from pathlib import Path
from threading import Thread

from cbtui.learning.exercise_files import (
    CannotPlaceError,
    StarterPlacement,
    before_the_solution,
    own_file,
    place_starter,
)
from cbtui.runs.judged.check_text import checked_text
from cbtui.runs.judged.checking import CheckedFile, check
from cbtui.screens.linear.asking import PostingHost
from cbtui.screens.linear.dialogue import Dialogue
from cbtui.screens.parts.part import ScreenPart
from lessons.judge import Judge
from lessons.lesson import BadLesson, Lesson
from lessons.progress import Progress
from sim.files.untrusted import program_text


@dataclass
class ExerciseInLines(ScreenPart):
    """Prints the task and creates the file; a changed file is run in the background and checked."""

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
        """Print the exercise and create its file, or check the existing file."""
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

    def action_solution(self) -> None:
        """Print the solution, after a confirmation the first time."""
        self.host.ask(self._ask_solution())

    def _ask_solution(self) -> Dialogue:
        lesson, known = self.lesson, self.progress.of(self.lesson.id)
        assert lesson.exercise is not None
        assert lesson.solution_path is not None
        if not known.solution:
            asked = before_the_solution(len(lesson.exercise.hints) - known.hints)
            if (yield f"{asked} Type yes to look at the solution, or nothing:") != "yes":
                return
        self.progress.look_at_solution(lesson.id)
        file = Path(lesson.file_name)
        begun = file if file.is_file() else lesson.starter_path
        self.host.tell(f"So {file.name} becomes the solution; {lesson.solution_path} has all of it.")
        texts = [program_text(path) or "" for path in (begun, lesson.solution_path) if path is not None]
        lines = list(told_difference(*texts))
        for line in lines or ["It is the solution, word for word."]:
            self.host.tell(line)

    def action_hint(self) -> None:
        """Print the next hint."""
        assert self.lesson.exercise is not None
        number = self.progress.of(self.lesson.id).hints + 1
        self.progress.take_hint(self.lesson.id, number)
        self.host.tell_page(self.lesson.exercise.hints[number - 1])


def told_difference(begun: str, solution: str) -> Iterator[str]:
    """Yield which lines of a file are replaced, and by which lines of the solution, with line numbers."""
    old, new = begun.splitlines(), solution.splitlines()
    for _, first, last, begins, ends in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if old[first:last] != new[begins:ends]:
            yield from (f"line {number + 1} goes: {old[number]}" for number in range(first, last))
            yield from (f"line {number + 1} comes: {new[number]}" for number in range(begins, ends))
