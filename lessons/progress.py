"""How far a learner has come in each lesson, kept in a file of plain text from one console to the next."""

import os
from collections.abc import Callable
from pathlib import Path

from msgspec import Struct, structs

from lessons.personal import state_folder
from lessons.state_file import StateFile, StateFileTexts

FILE_NAME = "progress.jsonl"
_WORDS = StateFileTexts("progress", "progress is not kept", "the lessons go on")


class LessonProgress(Struct, frozen=True, kw_only=True):
    """How far a learner has come in one lesson."""

    lesson: str
    answers: tuple[int, ...] = ()
    """What was answered to its predictions, in their order; as many as were answered."""
    seen: bool = False
    """A run was watched to where its predictions can be told from."""
    explained: bool = False
    """What the run showed, and why, was read."""
    hints: int = 0
    """How many hints were taken."""
    solution: bool = False
    """The solution was looked at."""
    passed: bool = False
    """The exercise passed every check."""


def usual_path() -> Path:
    """Where the file is kept: in the person's folder for the state of programs."""
    return state_folder() / FILE_NAME


def faulty_line(path: Path) -> int | None:
    """Return the number of a file's first line that is not progress, None without one; changes nothing.

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
        """Return how far the learner is in a lesson, as far as this console knows."""
        return self._known.get(lesson) or LessonProgress(lesson=lesson)

    def answer(self, lesson: str, place: int, answer: int) -> None:
        """Note an answer to the prediction at a place, the next one; a given answer stays as it is."""

        def answered(known: LessonProgress) -> LessonProgress:
            if place != len(known.answers):
                return known
            return structs.replace(known, answers=(*known.answers, answer))

        self._change(lesson, answered)

    def see(self, lesson: str) -> None:
        """Note that a run was watched."""
        self._change(lesson, lambda known: structs.replace(known, seen=True))

    def explain(self, lesson: str) -> None:
        """Note that what a run showed, and why, was read."""
        self._change(lesson, lambda known: structs.replace(known, seen=True, explained=True))

    def take_hint(self, lesson: str, number: int) -> None:
        """Note that the hint with that number, from 1, was taken."""
        self._change(lesson, lambda known: structs.replace(known, hints=max(known.hints, number)))

    def look_at_solution(self, lesson: str) -> None:
        """Note that the solution was looked at."""
        self._change(lesson, lambda known: structs.replace(known, solution=True))

    def passes(self, lesson: str) -> None:
        """Note that the exercise passed."""
        self._change(lesson, lambda known: structs.replace(known, passed=True))

    def reset(self, lesson: str) -> bool:
        """Forget everything about a lesson; tells whether there was anything."""
        nothing = LessonProgress(lesson=lesson)
        return self._change(lesson, lambda _: nothing) != nothing

    def refresh(self) -> None:
        """Take in what other consoles have written."""
        if os.path.lexists(self._file.path):
            with self._file.lock():
                self._read()

    def troubles(self) -> list[str]:
        """Return what went wrong and was not told yet."""
        return self._file.troubles()

    def _change(self, lesson: str, change: Callable[[LessonProgress], LessonProgress]) -> LessonProgress:
        """Change what is known of a lesson; what was known before."""
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
