"""Judges the runs of a learner's file by the checks of an exercise."""

import asyncio
from dataclasses import replace
from pathlib import Path

from cbtui.runs.judged.checking import LIMIT, CheckedFile, ObservedRun, real_limit
from cbtui.runs.judged.run_budget import RunBudget
from cbtui.runs.live.file_watch import content_of
from cbtui.runs.live.live_run import LiveRun
from cbtui.text.changed_lines import changed_lines
from cbtui.widgets.checks import ChecksSheet, CheckStatus
from cbtui.widgets.checks.exercise_sheet import ExerciseKeys, ExerciseTexts
from lessons.judge import Judge
from lessons.lesson import Lesson
from sim.engine.setup import RunSetup
from sim.trace.model import Nanoseconds


class Judging:
    """The state of an exercise on screen: the file's content, the run's budget, and the results.

    Raises BadLesson if the lesson's checks cannot be read.
    """

    def __init__(self, lesson: Lesson, following: Lesson | None, file: Path) -> None:
        self.file = file
        self.budget = RunBudget()
        """The run's budget."""
        self.sheet: ChecksSheet | None = None
        """The results of the run on screen; None until it is judged."""
        self.is_gone = False
        """Whether the file is missing."""
        self._lesson = lesson
        self._following = following
        self._judge = Judge(lesson)
        self._content: bytes | None = None

    def begin(self, setup: RunSetup) -> None:
        """Note that a run of the file's current content begins."""
        self._content = content_of(self.file)
        self.budget = RunBudget(real_limit(setup, LIMIT))
        self.sheet = None

    def is_changed_by(self, content: bytes | None) -> bool:
        """Note the file's content (None: it is missing); returns whether it must be run."""
        self.is_gone = content is None
        return content is not None and content != self._content

    def edit_to(self, content: bytes) -> str:
        """Say which lines of the file that the run was made from are others now; "" if none is."""
        return changed_lines(*((each or b"").decode(errors="replace") for each in (self._content, content)))

    def spent(self, run: LiveRun) -> str | None:
        """Update the budget; returns a sentence if the run exceeds it, else None."""
        if not run.alive:
            return None
        if run.paused or (run.virtual and run.speed is not None):
            self.budget.rest()
        else:
            self.budget.pass_time()
        return self.budget.spent(run.timeline, self.file.name)

    async def judge(self, observed: ObservedRun) -> CheckedFile:
        """Judge a finished run on the UI thread, which alone reads its timeline."""
        judged = []
        if observed.trouble is None:
            for check in self._judge.checks:
                judged.append(self._judge.judge(check, observed.timeline))
                await asyncio.sleep(0)
        return CheckedFile(tuple(judged), len(self._judge.checks), observed)

    def words(self, keys: ExerciseKeys) -> ExerciseTexts:
        """Return the texts on the exercise with these keys."""
        return ExerciseTexts(self._lesson, self._judge.checks, self.file.name, self._following, keys)

    def sheet_at(self, end: Nanoseconds, words: ExerciseTexts) -> ChecksSheet:
        """Return the results to show of a run that has come to ``end``."""
        sheet = self.sheet or words.running(end)
        return replace(sheet, news=words.gone, status=CheckStatus.FAILED) if self.is_gone else sheet
