"""The exercise screen: the learner's file is run and judged each time it is saved."""

import asyncio
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import ClassVar

import msgspec
from textual import on
from textual.app import ComposeResult
from textual.widget import Widget

from cbtui.engines.session import Deliver, Ended, OpenSession
from cbtui.keys.action import CHECKS, PANES, Scope
from cbtui.keys.keymap import STANDARD, Keymap, keymap_of
from cbtui.learning.lesson_page import page_of_exercise
from cbtui.learning.stage import LessonStep, StepState
from cbtui.looks.theme import Charset
from cbtui.runs.judged.checking import ObservedRun, ended_run
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import of_exercise
from cbtui.screens.compare_key import CompareKey
from cbtui.screens.parts.engine_keys import PaceKeys, RecordingKey, TimeRefusals
from cbtui.screens.parts.keys import Absences
from cbtui.screens.parts.own_file import FileRead, read_when_saved
from cbtui.screens.parts.restarts import Restarts
from cbtui.screens.parts.runs import RunController
from cbtui.screens.run import RunScreen
from cbtui.screens.teaching.exercise_help import ExerciseHelp
from cbtui.screens.teaching.judging import Judging
from cbtui.screens.teaching.learning import Learning, signs
from cbtui.widgets.checks import ChecksSheet, CheckStatus, ChecksView
from cbtui.widgets.checks.exercise_sheet import ExerciseKeys, ExerciseTexts
from cbtui.widgets.diagnosis import Diagnosis, DiagnosisLevel
from cbtui.widgets.passed_banner import PassedBanner
from lessons.lesson import Lesson
from sim.engine.setup import RealRos

_BUDGET_INTERVAL = 0.2
"""Seconds between two checks of a run's budget."""


class ExerciseScreen(RunScreen[LiveRun]):
    """Shows the judged run of a learner's file, and the results of its checks.

    The run gets only the lesson's inputs, so that the lanes show exactly what was judged.
    """

    CSS_PATH: ClassVar[list[Path]] = [  # type: ignore[assignment]  # a list is as good as one path
        Path(__file__).with_name("run.tcss"),
        Path(__file__).with_name("exercise.tcss"),
    ]
    PANES_HERE = (*PANES, CHECKS)
    FIRST_PANE = CHECKS
    AUTO_FOCUS = f"#{CHECKS}"

    def __init__(
        self,
        lesson: Lesson,
        lessons: Sequence[Lesson],
        file: Path,
        open_session: OpenSession,
        charset: Charset,
        real: RealRos | None = None,
    ) -> None:
        """Prepare the first run of the learner's file, on the model or on that ROS 2.

        Raises:
            BadLesson: its checks cannot be read.
        """
        subject = of_exercise(lesson, lessons, file, real)
        self._open_session = open_session
        self._judging = Judging(lesson, subject.following, file)
        runs = RunController(self._make_run, self.post)
        super().__init__(subject, charset, runs, live=lambda: runs.run)
        self._learning = Learning(
            self,
            self,
            self.panes,
            lesson,
            lambda state: page_of_exercise(lesson, state, signs(), self._task_in_words),
        )
        self.restarts = Restarts(
            self, runs, Changes(), self.show_new_run, speed=lambda: None, at_any_time=True
        )
        self.add_parts(
            PaceKeys(self, runs, self.navigation.action_live),
            TimeRefusals(self, runs, lambda action: self._parts.offer(action, ())),
            Absences(self, runs, lesson, lambda action: self._parts.offer(action, ()), self._kind),
            RecordingKey(self, runs, self.finisher),
            self.restarts,
            CompareKey(self, self.restarts),
            ExerciseHelp(
                self,
                self,
                self._learning,
                file,
                is_readable=lambda _: True,
                is_done=lambda: self._sheet.status is CheckStatus.PASSED,
            ),
            lesson=lambda: self.console.open_lesson(lesson, Changes(real=real)),
        )
        self._keys.first = self._first_keys
        runs.begin(speed=None)

    def _make_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        title = f"{self._judging.file.name}, run {self.runs.number}"
        setup = msgspec.structs.replace(self.subject.set_up(None, speed), title=title)
        self._judging.begin(setup)
        self.query(PassedBanner).set(display=False)
        return LiveRun(setup, self._open_session, deliver, ended)

    def _kind(self) -> str:
        return (
            "This runs your file as it will be judged, with given inputs: what you change is the file. "
            f"{self.key('lesson')} leads to the lesson, where the rest can be tried."
        )

    def _first_keys(self) -> Sequence[str]:
        """Return the labels of what leads on; to run again takes no key, as saving the file does it."""
        if self._sheet.status is CheckStatus.PASSED:
            return ("next",)
        help_left = "hint" if self._keys.offer("hint", ()) else "solution"
        on_checks = ("check", "go there", "watch", help_left, "lesson")
        return ("editor", *(on_checks if isinstance(self.focused, ChecksView) else ()))

    # what is shown

    def compose(self) -> ComposeResult:
        """Lay out the screen, and over it the banner."""
        yield from super().compose()
        yield PassedBanner(self.charset)

    def compose_panes(self) -> Iterator[Widget]:
        """Yield the panes, the checks first: in the grid they stand before the code."""
        yield ChecksView(self._sheet, id=CHECKS)
        yield from super().compose_panes()

    def on_mount(self) -> None:
        """Watch the file and the run."""
        self.set_interval(_BUDGET_INTERVAL, self.check_budget)
        self.run_worker(read_when_saved(self._judging.file, self.post_message, self.tell), group="file")

    def draw_pane(self, pane: Widget) -> None:
        """Show the moment on screen on one pane."""
        if isinstance(pane, ChecksView):
            pane.show(self._sheet)
        else:
            super().draw_pane(pane)

    def page(self) -> Mapping[str, str]:
        """Return the task, the hints, and what was explained already."""
        return self._learning.page()

    @property
    def steps(self) -> tuple[LessonStep, ...]:
        """The steps through the lesson; the last one counts the checks that pass.

        While a run of a passed exercise is not judged yet, the exercise is still shown as done.
        """
        is_done = self._sheet.status is CheckStatus.OPEN and self._learning.progress.passed
        return self._learning.steps(CheckStatus.PASSED.sign if is_done else self._sheet.count)

    def diagnosis(self) -> Diagnosis:
        """Return the diagnosis of the moment on screen, or the result of a finished run."""
        if self.navigation.playhead.at is not None or self.runs.run.alive:
            return super().diagnosis()
        sheet, has_failed = self._sheet, self._sheet.status is CheckStatus.FAILED
        if has_failed and not sheet.note:
            if self.query_one(ChecksView).display:
                return Diagnosis("no check was judged: the checks pane says why", DiagnosisLevel.TROUBLE)
            return Diagnosis(sheet.news, DiagnosisLevel.TROUBLE, stays=True)
        # A problem of the run takes the place of a diagnosis that is fine.
        alone = not any(each.is_problem for each in self.runs.findings.findings)
        return Diagnosis(sheet.news, DiagnosisLevel.TROUBLE if has_failed and alone else DiagnosisLevel.FINE)

    @property
    def _words(self) -> ExerciseTexts:
        return self._words_in(keymap_of(self.app), self.charset)

    def _words_in(self, keymap: Keymap, charset: Charset) -> ExerciseTexts:
        actions = ("open_source", "watch", "lesson", "next_lesson")
        return self._judging.words(
            ExerciseKeys(*(keymap.sign(Scope.LESSON, action, charset) for action in actions))
        )

    @property
    def _task_in_words(self) -> str:
        """The task with the registry's keys, which the guide replaces by those in force."""
        return self._words_in(STANDARD, Charset.ASCII).page(self._judging.file)

    @property
    def _sheet(self) -> ChecksSheet:
        return self._judging.sheet_at(self.runs.timeline.end, self._words)

    # runs

    @on(RunController.Delivered)
    def _count(self, message: RunController.Delivered) -> None:
        if message.run == self.runs.number:
            self._judging.budget.write(message.events)

    @on(RunController.Over)
    def _judge_when_over(self, message: RunController.Over) -> None:
        if message.run == self.runs.number:
            self._start_judging(ended_run(self.runs.timeline, self._judging.file.name, message.trouble))

    def check_budget(self) -> None:
        """Abort the run if it exceeds its budget."""
        sentence = self._judging.spent(self.runs.run)
        if sentence is not None:
            self._break_off(sentence)

    def _break_off(self, sentence: str) -> None:
        """Abort a run; further events of its engine are ignored."""
        self.runs.disown()
        run = self.runs.run
        self.finisher.finish(run.over(sentence))
        self.run_worker(asyncio.to_thread(run.stop), group="stop")
        self._start_judging(ObservedRun(run.timeline, sentence, broken_off=True))

    def _start_judging(self, observed: ObservedRun) -> None:
        self.run_worker(self._judge(self.runs.number, observed), group="judge", exclusive=True)

    async def _judge(self, number: int, observed: ObservedRun) -> None:
        checked = await self._judging.judge(observed)
        if number != self.runs.number:
            return
        self._judging.sheet = self._words.judged(checked)
        self.update_findings()
        if checked.good:
            if not self._learning.progress.passed:
                self._celebrate(checked.total)
            self._learning.store.passes(self._learning.lesson.id)
            await self._learning.update_page()

    def _celebrate(self, checks: int) -> None:
        """Show over the lanes that the exercise passed."""
        steps = self._learning.steps()
        left = [step.name for step in steps if step.state is not StepState.DONE and step.name != "Exercise"]
        if left:
            how_to_continue = f"left of the lesson: {', '.join(left).lower()}"
        elif self.subject.following is not None:
            how_to_continue = f"{self.key('next_lesson')} opens the next lesson"
        else:
            how_to_continue = "that was the last lesson"
        text = f"✓ {self._learning.lesson.title}: all {checks} checks pass, {how_to_continue}"
        self.app.clear_notifications()  # hints are no longer needed
        self.query_one(PassedBanner).celebrate(text)

    # the file

    @on(FileRead)
    async def _take_saved(self, message: FileRead) -> None:
        if self._judging.is_changed_by(message.content) and message.content is not None:
            edit = self._judging.edit_to(message.content)
            await self.restarts.again(self.restarts.changes, edit=edit)
        else:
            self.redraw()

    async def action_watch(self) -> None:
        """Run the file again at real-time speed."""
        await self.restarts.start(Changes(), speed=1.0)
