"""The learner's progress in each lesson, stored in a text file that all consoles share."""

import os
from collections.abc import Callable
from pathlib import Path

from msgspec import Struct, structs

from lessons.personal import state_folder
from lessons.state_file import StateFile, StateFileTexts

FILE_NAME = "progress.jsonl"
_WORDS = StateFileTexts("progress", "progress is not kept", "the lessons go on")


class LessonProgress(Struct, frozen=True, kw_only=True):
    """The learner's progress in one lesson."""

    lesson: str
    answers: tuple[int, ...] = ()
    """The answers to its predictions, in their order, as far as they were given."""
    seen: bool = False
    """Enough of a run was watched to judge the predictions."""
    explained: bool = False
    """The true answers and the explanation were read."""
    hints: int = 0
    """The number of taken hints."""
    solution: bool = False
    """The solution was viewed."""
    passed: bool = False
    """The exercise passed every check."""


def usual_path() -> Path:
    """Return the path of the file, in the user's folder for state."""
    return state_folder() / FILE_NAME


def faulty_line(path: Path) -> int | None:
    """Return the number of a file's first invalid line, None if there is none; changes nothing.

    Raises:
        OSError: the file cannot be read.
    """
    return _file(path).faulty_line()


class Progress:
    """The progress in all lessons: a file of JSON lines, one for each lesson.

    Every change reads the file again, under a lock that other consoles respect, so that none is lost. A file
    that cannot be read or written leaves the progress in memory, see ``StateFile``. Not thread-safe.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._file = _file(usual_path() if path is None else path)
        self._known: dict[str, LessonProgress] = {}
        self.refresh()

    def of(self, lesson: str) -> LessonProgress:
        """Return the learner's progress in a lesson, as far as this console knows it."""
        return self._known.get(lesson) or LessonProgress(lesson=lesson)

    def answer(self, lesson: str, place: int, answer: int) -> None:
        """Store the answer to the next prediction, the one at ``place``; a given answer is never changed."""

        def answered(known: LessonProgress) -> LessonProgress:
            if place != len(known.answers):
                return known
            return structs.replace(known, answers=(*known.answers, answer))

        self._change(lesson, answered)

    def see(self, lesson: str) -> None:
        """Note that a run was watched."""
        self._change(lesson, lambda known: structs.replace(known, seen=True))

    def explain(self, lesson: str) -> None:
        """Note that the true answers and the explanation were read."""
        self._change(lesson, lambda known: structs.replace(known, seen=True, explained=True))

    def take_hint(self, lesson: str, number: int) -> None:
        """Note that the hint with that number, from 1, was taken."""
        self._change(lesson, lambda known: structs.replace(known, hints=max(known.hints, number)))

    def look_at_solution(self, lesson: str) -> None:
        """Note that the solution was viewed."""
        self._change(lesson, lambda known: structs.replace(known, solution=True))

    def passes(self, lesson: str) -> None:
        """Note that the exercise passed."""
        self._change(lesson, lambda known: structs.replace(known, passed=True))

    def reset(self, lesson: str) -> bool:
        """Forget everything about a lesson; returns whether there was anything."""
        nothing = LessonProgress(lesson=lesson)
        return self._change(lesson, lambda _: nothing) != nothing

    def refresh(self) -> None:
        """Read what other consoles have written."""
        if os.path.lexists(self._file.path):
            with self._file.lock():
                self._read()

    def troubles(self) -> list[str]:
        """Return the errors that were not reported yet."""
        return self._file.troubles()

    def _change(self, lesson: str, change: Callable[[LessonProgress], LessonProgress]) -> LessonProgress:
        """Change the progress in a lesson; returns the progress before."""
        with self._file.lock():
            self._read()
            before = self.of(lesson)
            after = change(before)
            if after != before:
                self._known[lesson] = after
                self._write()
        return before

    def _read(self) -> None:
        content = self._file.read()
        if content is None:
            return
        found = {entry.lesson: entry for entry in content.entries}
        if content.broken:
            self._known |= found
            self._write()
        else:
            self._known = found

    def _write(self) -> None:
        self._file.write(each for each in self._known.values() if each != LessonProgress(lesson=each.lesson))


def _file(path: Path) -> StateFile[LessonProgress]:
    return StateFile(path, LessonProgress, _WORDS)
