"""The content of the checks pane of an exercise."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cbtui.runs.judged.check_text import faults, verdict_line
from cbtui.runs.judged.checking import CheckedFile
from cbtui.widgets.checks import CheckRow, ChecksSheet, CheckStatus
from lessons.checks import Check
from lessons.judge import JudgedCheck
from lessons.lesson import Lesson
from sim.diagnosis import with_stop
from sim.quantities.nanoseconds import SECOND
from sim.quantities.plural import counted
from sim.trace.model import Nanoseconds


@dataclass(frozen=True)
class ExerciseKeys:
    """The keys that the texts name, in display form."""

    editor: str
    watch: str
    lesson: str
    next_lesson: str


class ExerciseTexts:
    """Texts on one lesson's exercise; ``name`` is the learner's file, ``following`` the next lesson."""

    def __init__(
        self, lesson: Lesson, checks: Sequence[Check], name: str, following: Lesson | None, keys: ExerciseKeys
    ) -> None:
        assert lesson.exercise is not None, "only exercises are told about here"
        self._task = " ".join(lesson.exercise.asks.split())
        self._asks = self._task.replace("`", "")
        self._seconds = lesson.run.seconds
        self._open = tuple(CheckRow(check.asks) for check in checks)
        self._name = name
        self._following = following
        self._keys = keys

    def running(self, at: Nanoseconds) -> ChecksSheet:
        """Return the sheet of a run that has come to a moment and is not judged yet."""
        news = f"{self._name} runs: {at / SECOND:.1f} s of {self._seconds:g} s"
        return ChecksSheet(news, CheckStatus.OPEN, self._open, asks=self._asks)

    def judged(self, checked: CheckedFile) -> ChecksSheet:
        """Return the sheet with the results of a run."""
        if checked.run.trouble is not None:
            news = f"{with_stop(checked.run.trouble)} {self._way_on}"
            return ChecksSheet(news, CheckStatus.FAILED, self._open, asks=self._asks)
        rows = tuple(map(_row, checked.judged))
        if checked.good:
            return ChecksSheet(self._done(checked.total), CheckStatus.PASSED, rows, asks=self._asks)
        failed = checked.total - checked.passed
        fail = "fails" if failed == 1 else "fail"
        news = f"{failed} of {counted(checked.total, 'check')} {fail}. {self._way_on}"
        return ChecksSheet(news, CheckStatus.FAILED, rows, tuple(faults(checked.run.timeline)), self._asks)

    def page(self, file: Path) -> str:
        """Return the task and how to work on it, as Markdown."""
        keys = self._keys
        return (
            f"# Exercise\n\n{self._task}\n\n"
            f"Your file is `{file}`. `{keys.editor}` opens it in your editor; any other editor works too. "
            "Whenever you save it, it is run and checked. "
            f"`{keys.watch}` runs it slowly enough to watch. `{keys.lesson}` goes back to the lesson."
        )

    @property
    def gone(self) -> str:
        """The sentence on a missing file."""
        return f"{self._name} is gone; it will be run and checked again when it is back."

    @property
    def _way_on(self) -> str:
        return f"{self._keys.editor} opens {self._name}; saving it checks it again."

    def _done(self, total: int) -> str:
        done = f"All {counted(total, 'check')} pass: the exercise is done."
        if self._following is None:
            return f"{done} It belongs to the last lesson."
        return f"{done} {self._keys.next_lesson} opens the next lesson, {self._following.title}."


def _row(judged: JudgedCheck) -> CheckRow:
    status = CheckStatus.PASSED if judged.verdict.passed else CheckStatus.FAILED
    return CheckRow(judged.check.asks, status, verdict_line(judged), judged.verdict.at)
