"""The screen on which the learner schedules the threads: of a puzzle, or of a run from a moment on."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

from textual import on
from textual.widget import Widget
from textual.widgets import OptionList

from cbtui.engines.session import Deliver, Ended, OpenSession
from cbtui.keys.action import CHOICE, PANES
from cbtui.looks.theme import Charset
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.live.playhead import Playhead
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.parts.choices import Choices
from cbtui.screens.parts.engine_keys import RecordingKey
from cbtui.screens.parts.keys import Absences
from cbtui.screens.parts.restarts import Restarts
from cbtui.screens.parts.runs import RunController
from cbtui.screens.run import RunScreen
from cbtui.widgets.choice import ChoiceOptions, ChoiceView
from cbtui.widgets.code import CodeView, StandingThread
from cbtui.widgets.diagnosis import Diagnosis, DiagnosisLevel
from cbtui.widgets.lanes.names import short_thread
from lessons.puzzles import Puzzle
from sim.trace.events import ChoiceAsked

_PUZZLE_SPAN = 200_000_000
"""Nanoseconds that the lanes show of a puzzle: all of its run."""


class ChoosingScreen(RunScreen[LiveRun]):
    """Runs a program that stops at each choice among its threads until the learner has chosen.

    ``puzzle`` None: without a goal.
    """

    CSS_PATH: ClassVar[list[Path]] = [  # type: ignore[assignment]  # a list is as good as one path
        Path(__file__).with_name("run.tcss"),
        Path(__file__).with_name("choosing.tcss"),
    ]
    PANES_HERE = (*PANES, CHOICE)
    FIRST_PANE = CHOICE
    AUTO_FOCUS = "ChoiceOptions"

    def __init__(
        self, subject: ShownProgram, open_session: OpenSession, charset: Charset, puzzle: Puzzle | None = None
    ) -> None:
        self._open_session = open_session
        runs = RunController(self._make_run, self.post)
        super().__init__(subject, charset, runs)
        restarts = Restarts(self, runs, Changes(), self.show_new_run, speed=lambda: None)
        self._choices = Choices(self, runs, restarts, puzzle)
        if puzzle is not None:
            self.navigation.playhead = Playhead(span=_PUZZLE_SPAN)
        absences = Absences(self, runs, None, lambda action: self._parts.offer(action, ()), self._kind)
        self.add_parts(self._choices, RecordingKey(self, runs, self.finisher), absences)
        runs.begin(speed=None)

    def _make_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        return LiveRun(self._choices.set_up(self.subject, speed), self._open_session, deliver, ended)

    def _kind(self) -> str:
        choice = "Here you only choose which thread goes on next"
        solved = f"; {self.key('solution')} shows the solution" if self._choices.puzzle else ""
        return f"{choice}: {self.key('undo')} takes a choice back{solved}."

    def compose_panes(self) -> Iterator[Widget]:
        """Yield the panes, the choice before the code."""
        yield ChoiceView(id=CHOICE)
        yield from super().compose_panes()

    def draw_pane(self, pane: Widget) -> None:
        """Show the moment on screen on one pane."""
        if isinstance(pane, ChoiceView):
            self._choices.check_goal()  # first, as the sheet says that a finished run has missed the goal
            pane.show(self._choices.sheet)
            return
        if isinstance(pane, CodeView):
            pane.standing = tuple(self._standing())
        super().draw_pane(pane)

    def _standing(self) -> Iterator[StandingThread]:
        """Yield the threads that may be chosen at the moment on screen."""
        asked = self._open_question
        for thread, place in zip(asked.threads, asked.places, strict=True) if asked else ():
            yield StandingThread(short_thread(thread), *place)

    @property
    def _open_question(self) -> ChoiceAsked | None:
        """The question about the moment on screen."""
        is_present = self.runs.run.alive and self.navigation.playhead.at is None
        return self._choices.question if is_present else None

    def diagnosis(self) -> Diagnosis:
        """Return the diagnosis; at an open choice a thread may wait that the trace does not tell of yet."""
        told = super().diagnosis()
        if told.stays and told.level is DiagnosisLevel.FINE and self._choices.reached is not None:
            return replace(told, text=f"the goal is reached; {self.key('run_again')} begins again")
        if self._open_question is None or told.level is not DiagnosisLevel.FINE:
            return told
        return Diagnosis("time stands still until you choose who goes on", DiagnosisLevel.PENDING)

    def drawn(self) -> None:
        """Show the code beside the choice, and check whether the goal is reached."""
        self.set_class(self.panes.current == CHOICE, "-choosing")
        self._choices.check_goal()

    @on(RunController.Delivered)
    def _take_question(self, message: RunController.Delivered) -> None:
        if message.run == self.runs.number:
            self._choices.take(message.events)
            self.redraw()

    @on(OptionList.OptionSelected)
    def _choose(self, message: OptionList.OptionSelected) -> None:
        self._choose_in_the_present(message.option_index)

    @on(ChoiceOptions.ChosenUnseen)
    def _choose_unseen(self, message: ChoiceOptions.ChosenUnseen) -> None:
        self._choose_in_the_present(message.option)

    def _choose_in_the_present(self, option: int) -> None:
        """Choose an option; whoever looks back is first brought to the moment that the question is about."""
        if self.runs.run.alive and not self._choices.was_asked:
            self.tell("Nothing is asked yet.")
        elif self.navigation.playhead.at is None or not self.runs.run.alive:
            self._choices.choose(option)
        else:
            self.navigation.action_live()
            self.tell("Nothing is chosen yet: that was the past, and here is the present. Choose now.")

    @on(OptionList.OptionHighlighted)
    def _show_line(self, message: OptionList.OptionHighlighted) -> None:
        """Show the line in front of which the highlighted thread stands."""
        options = self.query_one(ChoiceView).sheet.options
        if message.option_index < len(options) and options[message.option_index].line:
            option = options[message.option_index]
            self.query_one(CodeView).show_line(option.file, option.line)
