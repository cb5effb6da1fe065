"""The screen of a lesson or of the user's own program."""

import asyncio
from collections.abc import Iterator, Mapping
from dataclasses import replace

from textual import on

from cbtui.engines.session import Deliver, Ended, OpenSession
from cbtui.learning.lesson_page import PageSection, page_of
from cbtui.learning.stage import LessonStep
from cbtui.looks.theme import Charset
from cbtui.runs.live.live_run import LiveRun, RunState
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.choosing import ChoosingScreen
from cbtui.screens.compare_key import CompareKey
from cbtui.screens.parts.choices import TakeOver
from cbtui.screens.parts.cures import CureTrials
from cbtui.screens.parts.engine_keys import PaceKeys, RecordingKey, TimeRefusals, TypingKeys, WorldKeys
from cbtui.screens.parts.keys import Absences, Refusals
from cbtui.screens.parts.own_file import FileRead, OwnFile, read_when_saved
from cbtui.screens.parts.part import ScreenPart
from cbtui.screens.parts.restarts import Restarts, SetUpKeys
from cbtui.screens.parts.runs import RunController
from cbtui.screens.run import RunScreen
from cbtui.screens.teaching.exercise_help import ExerciseHelp
from cbtui.screens.teaching.learning import Learning, signs
from cbtui.screens.teaching.predictions import Predictions
from cbtui.screens.windows.prediction import PredictionExit
from cbtui.screens.windows.tour import LINE, TourScreen
from cbtui.widgets.code import CodeView
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.shell import ProgramKeyboard, Prompt, ShellView
from lessons.lesson import Lesson
from sim.quantities.nanoseconds import SECOND

_TOUR_SPEED = 0.1
_TOUR_END = 39 * SECOND // 10
"""The tour's run is slow, and pauses before it shows what is to be predicted."""


class LessonScreen(RunScreen[LiveRun]):
    """Runs a program with all commands of an engine.

    A lesson asks for predictions before its run and explains them after it.
    """

    def __init__(
        self,
        subject: ShownProgram,
        open_session: OpenSession,
        charset: Charset,
        changes: Changes | None = None,
        *,
        tour: bool = False,
    ) -> None:
        self._open_session = open_session
        runs = RunController(self._make_run, self.post)
        super().__init__(subject, charset, runs, live=lambda: runs.run)
        self.restarts = Restarts(
            self, runs, changes or Changes(), self.show_new_run, speed=lambda: runs.run.speed
        )
        comparison = CompareKey(self, self.restarts)
        self.selection.cures = CureTrials(runs, self.restarts, subject, comparison.action_compare)
        self._learning: Learning | None = None
        self._predictions: Predictions | None = None
        self._own_file = (
            OwnFile(self, self, runs, self.restarts, self.panes, subject.node_path)
            if subject.is_own_file
            else None
        )
        lesson, more = subject.lesson, {}

        def is_available(action: str) -> bool:
            return self._parts.offer(action, ())

        if lesson is not None and lesson.exercise is not None:
            more["exercise"] = lambda: self.console.open_exercise(lesson, runs.run.setup.real)
        self.add_parts(
            PaceKeys(self, runs, self.navigation.action_live),
            RecordingKey(self, runs, self.finisher),
            WorldKeys(self, runs),
            TypingKeys(runs, self.panes, lambda: self.query_one(ShellView)),
            self.restarts,
            comparison,
            SetUpKeys(self, runs, self.restarts, self.selection, subject),
            TakeOver(
                self,
                runs,
                subject,
                lambda taken: self.ask(ChoosingScreen(taken, open_session, charset), None),
            ),
            *([] if lesson is None else self._teaching_parts(lesson)),
            Refusals(self, lesson, is_available),
            Absences(self, runs, lesson, is_available),
            TimeRefusals(self, runs, is_available),
            **more,
        )
        self._is_tour = tour
        runs.begin(speed=_TOUR_SPEED if tour else 1.0)

    def _teaching_parts(self, lesson: Lesson) -> Iterator[ScreenPart]:
        learning = self._learning = Learning(
            self, self, self.panes, lesson, lambda state: page_of(lesson, state, signs())
        )
        self._predictions = Predictions(self, self, self.runs, learning)
        yield self._predictions
        if lesson.exercise is not None:
            yield ExerciseHelp(self, self, learning, file=None, is_readable=lambda state: state.progress.seen)

    @property
    def changes(self) -> Changes:
        """The user's changes to the program's set-up."""
        return self.restarts.changes

    def page(self) -> Mapping[str, str]:
        """Return the unlocked sections of the guide."""
        if self._own_file is not None:
            return self._own_file.page()
        return super().page() if self._learning is None else self._learning.page()

    @property
    def steps(self) -> tuple[LessonStep, ...]:
        """The steps through the lesson."""
        return () if self._learning is None else self._learning.steps()

    def _make_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        if self._own_file is not None:
            self._own_file.begin()
        return LiveRun(self.restarts.set_up(self.subject, speed), self._open_session, deliver, ended)

    # the lesson

    def start(self) -> None:
        """Start after the predictions, which are about the unchanged node."""
        if self._is_tour:
            super().start()
            self.ask(TourScreen(self._show_round, self.charset), self._end_tour)
            return
        predictions = self._predictions
        unchanged = not replace(self.changes, real=None).words
        if predictions is not None and predictions.can_predict and unchanged:
            predictions.ask(self._start_after)
        else:
            super().start()

    def _show_round(self, place: str) -> None:
        """Bring the lanes, the line above the keys or a pane to the fore."""
        self.query_one(Lanes).set_class(place == "lanes", "-shown")
        self.query_one(DiagnosisLine).set_class(place == LINE, "-shown")
        if place in self.panes.names:
            self.panes.show(place)

    async def _end_tour(self, _: None) -> None:
        """Begin the lesson itself, with its predictions."""
        self._is_tour = False
        self._show_round("guide")
        before = self.runs.run
        self.runs.begin(speed=1.0)
        self.show_new_run()
        await asyncio.to_thread(before.stop)
        self.start()

    async def _start_after(self, way: PredictionExit | None) -> None:
        learning = self._learning
        if way is PredictionExit.ON and learning is not None:
            await learning.update_page()
            learning.guide.go_to(PageSection.TASK)
            super().start()
        else:
            self.dismiss()

    def drawn(self) -> None:
        """Unlock the explanation once enough of the run was watched; a tour gives nothing away."""
        run = self.runs.run
        if self._own_file is not None:
            self._own_file.update_guide()
        if self._is_tour:
            if run.timeline.end >= _TOUR_END and not run.paused:
                run.pause()
        elif self._predictions is not None:
            self._predictions.check_whether_watched()

    # a learner's own file

    def on_mount(self) -> None:
        """Watch the file."""
        if self._own_file is not None:
            file = self._own_file.file
            self.run_worker(read_when_saved(file, self.post_message, self.tell), group="file")

    @on(FileRead)
    async def _take_saved(self, message: FileRead) -> None:
        if self._own_file is not None:
            await self._own_file.take(message.content)

    @on(CodeView.ModuleSaved)
    async def _take_module(self, message: CodeView.ModuleSaved) -> None:
        if self._own_file is not None:
            await self._own_file.run_anew(message.name)

    @on(Predictions.Found)
    async def _take_outcome(self, message: Predictions.Found) -> None:
        if self._predictions is not None:
            await self._predictions.take(message)

    def on_unmount(self) -> None:
        """Leave no engine behind."""
        if self.selection.cures is not None:
            self.selection.cures.leave()
        if self._predictions is not None:
            self.console.end_later(self._predictions.leave())

    # what is typed

    @on(Prompt.LineSubmitted)
    def _give_line(self, message: Prompt.LineSubmitted) -> None:
        run = self.runs.run
        run.give_line(message.text)
        if run.state is RunState.PAUSED:
            when = f"when it goes on: {self.key('resume')}"
            told = f"Time stands still: what the nodes are asked they answer {when}."
            self.tell(told, lambda: run.state is RunState.PAUSED)

    @on(Prompt.LineInterrupted)
    def _interrupt_line(self) -> None:
        self.runs.run.interrupt_line()

    @on(Prompt.CompletionWanted)
    def _complete_line(self, message: Prompt.CompletionWanted) -> None:
        self.runs.run.complete_line(message.text, message.cursor)

    @on(ProgramKeyboard.TextTyped)
    def _type(self, message: ProgramKeyboard.TextTyped) -> None:
        self.runs.run.type(message.text)
