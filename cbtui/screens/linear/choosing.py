"""The console in lines on which the learner schedules the threads by numbers."""

from collections.abc import Iterable
from dataclasses import dataclass

from cbtui.engines.session import Deliver, Ended, OpenSession
from cbtui.keys.action import Scope
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.linear.console import LinearConsole, LineTerminal
from cbtui.screens.linear.dialogue import Dialogue
from cbtui.screens.linear.narrative import LEAST
from cbtui.screens.parts.choices import Choices
from cbtui.screens.parts.part import ScreenPart
from cbtui.screens.parts.restarts import Restarts
from cbtui.widgets.choice import ChoiceSheet
from lessons.puzzles import Puzzle
from sim.trace.events import AnyEvent


class ChoosingConsole(LinearConsole[LiveRun]):
    """Runs a program that stops at each choice among its threads until the learner has typed a number.

    ``puzzle`` None: without a goal.
    """

    SCOPE = Scope.CHOICE

    def __init__(
        self,
        terminal: LineTerminal,
        subject: ShownProgram,
        open_session: OpenSession,
        puzzle: Puzzle | None = None,
    ) -> None:
        super().__init__(terminal, subject, self._make_run)
        self._open_session = open_session
        restarts = Restarts(self, self.runs, Changes(), self.show_new_run, speed=lambda: None)
        self._choices = Choices(self, self.runs, restarts, puzzle)
        self._told = ChoiceSheet("")
        self.add_parts(self._choices, NumberKeys(self, self._choices))
        self.telling.narrative.least = LEAST[0]
        self.runs.begin(None)
        self.telling.begin()

    def _make_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        return LiveRun(self._choices.set_up(self.subject, speed), self._open_session, deliver, ended)

    @property
    def is_ready(self) -> bool:
        """Whether a choice, or the result of all choices, has been printed."""
        return self._told == self._choices.sheet

    def greet(self) -> Dialogue:
        """Print the goal, and start the run."""
        self.tell_page(self.subject.guide)
        self.tell(self.runs.run.start())
        yield from ()

    def take_events(self, events: Iterable[AnyEvent]) -> None:
        """Receive events, questions among them."""
        super().take_events(events)
        self._choices.take(events)
        self.turn()

    def turn(self) -> None:
        """Print the news and the current question."""
        self._choices.check_goal()
        super().turn()
        choices, sheet = self._choices, self._choices.sheet
        is_under_way = choices.question is None and self.runs.run.alive and choices.reached is None
        if sheet == self._told or is_under_way:
            return
        self._told = sheet
        self.tell(sheet.news)
        for number, option in enumerate(sheet.options, start=1):
            self.tell(f"{number}: {option.text}")
        for reason in sheet.kept:
            self.tell(f"not now: {reason}")


@dataclass
class NumberKeys(ScreenPart):
    """Chooses by a number."""

    host: LinearConsole[LiveRun]
    choices: Choices

    def action_choose(self, number: int) -> None:
        """Choose the option with a number, from 1."""
        self.choices.choose(number - 1)
