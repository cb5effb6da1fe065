"""The screen of a lesson or of the user's own program."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import msgspec
from textual import on

from cbtui.engines.session import Deliver, Ended, OpenSession
from cbtui.learning.lesson_page import PageSection, page_of
from cbtui.looks.theme import Charset
from cbtui.runs.live.live_recording import LiveRecording
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.parts.engine_keys import PaceKeys, RecordingKey, TypingKeys, WorldKeys
from cbtui.screens.parts.exercise_help import ExerciseHelp
from cbtui.screens.parts.learning import Learning, signs
from cbtui.screens.parts.part import ScreenPart
from cbtui.screens.parts.predictions import Predictions
from cbtui.screens.parts.restarts import Restarts, SetUpKeys
from cbtui.screens.parts.runs import RunController
from cbtui.screens.prediction import PredictionExit
from cbtui.screens.run import RunScreen
from cbtui.widgets.shell import ProgramKeyboard, Prompt, ShellView
from lessons.lesson import Lesson
from sim.engine.setup import Keyboard


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
    ) -> None:
        self._open_session = open_session
        runs = RunController(self._make_run, self.post)
        super().__init__(subject, charset, runs, live=lambda: runs.run)
        self.restarts = Restarts(
            self, runs, changes or Changes(), self.show_new_run, speed=lambda: runs.run.speed
        )
        self._learning: Learning | None = None
        self._predictions: Predictions | None = None
        lesson, more = subject.lesson, {}
        if lesson is not None and lesson.exercise is not None:
            more["exercise"] = lambda: self.console.open_exercise(lesson, runs.run.setup.real)
        self.add_parts(
            PaceKeys(self, runs),
            RecordingKey(self, runs, self.finisher),
            WorldKeys(runs),
            TypingKeys(runs, self.panes, lambda: self.query_one(ShellView)),
            self.restarts,
            SetUpKeys(self, runs, self.restarts, self.selection, subject),
            *([] if lesson is None else self._teaching_parts(lesson)),
            **more,
        )
        runs.begin(speed=1.0)

    def _teaching_parts(self, lesson: Lesson) -> Iterator[ScreenPart]:
        learning = self._learning = Learning(
            self, self, self.panes, lesson, lambda standing: page_of(lesson, standing, signs())
        )
        self._predictions = Predictions(self, self, self.runs, learning)
        yield self._predictions
        if lesson.exercise is not None:
            yield ExerciseHelp(
                self, self, learning, file=None, is_readable=lambda standing: standing.progress.seen
            )

    @property
    def changes(self) -> Changes:
        """The user's changes to the program's set-up."""
        return self.restarts.changes

    @property
    def recording(self) -> LiveRecording | None:
        """What records the run."""
        return self.runs.run.recording

    def page(self) -> Mapping[str, str]:
        """Return the unlocked sections of the guide."""
        return super().page() if self._learning is None else self._learning.page()

    def _make_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        changes = self.changes
        setup = changes.applied(self.subject.set_up(changes.threads, speed))
        setup = msgspec.structs.replace(setup, keyboard=Keyboard.LIVE)
        return LiveRun(setup, self._open_session, deliver, ended)

    # the lesson

    def start(self) -> None:
        """Start after the predictions, which are about the unchanged node."""
        predictions = self._predictions
        unchanged = not replace(self.changes, real=None).words
        if predictions is not None and predictions.can_predict and unchanged:
            predictions.ask(self._start_after)
        else:
            super().start()

    async def _start_after(self, way: PredictionExit | None) -> None:
        learning = self._learning
        if way is PredictionExit.ON and learning is not None:
            await learning.update_page()
            learning.guide.go_to(PageSection.TASK)
            super().start()
        else:
            self.action_leave()

    def drawn(self) -> None:
        """Unlock the explanation once enough of the run was watched."""
        if self._predictions is not None:
            self._predictions.look_whether_watched()

    @on(Predictions.Found)
    async def _take_outcome(self, message: Predictions.Found) -> None:
        if self._predictions is not None:
            await self._predictions.take(message)

    async def on_unmount(self) -> None:
        """Leave no engine behind."""
        if self._predictions is not None:
            await self._predictions.leave()

    # what is typed

    @on(Prompt.LineSubmitted)
    def _give_line(self, message: Prompt.LineSubmitted) -> None:
        self.runs.run.give_line(message.text)

    @on(Prompt.LineInterrupted)
    def _interrupt_line(self) -> None:
        self.runs.run.interrupt_line()

    @on(Prompt.CompletionWanted)
    def _complete_line(self, message: Prompt.CompletionWanted) -> None:
        self.runs.run.complete_line(message.text, message.cursor)

    @on(ProgramKeyboard.TextTyped)
    def _type(self, message: ProgramKeyboard.TextTyped) -> None:
        self.runs.run.type(message.text)
