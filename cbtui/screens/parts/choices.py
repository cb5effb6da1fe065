"""Choosing which thread goes on: the choices of a run so far, and the goal of a puzzle."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from itertools import chain

import msgspec

from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import ShownProgram, of_moment
from cbtui.screens.parts.part import RunHost, ScreenPart
from cbtui.screens.parts.restarts import Restarts
from cbtui.screens.parts.runs import RunController
from cbtui.widgets.choice import ChoiceSheet, kept_of, options_of
from lessons.catalogue import find
from lessons.puzzles import Puzzle
from sim.clock.moves import Moves, moves_of, moves_text
from sim.engine.setup import RunSetup
from sim.quantities.plural import counted
from sim.trace.events import AnyEvent, ChoiceAsked

_MOVE = "A move is a choice other than 1."
_EARLY = 9
"""The most options that are kept for choices to come; a held key types many."""


@dataclass
class Choices(ScreenPart):
    """Asks at each choice of a run; taking choices back restarts the run without them.

    ``puzzle`` None: there is no goal.
    """

    host: RunHost
    runs: RunController[LiveRun]
    restarts: Restarts
    puzzle: Puzzle | None = None
    question: ChoiceAsked | None = None
    """The current question."""
    was_asked: bool = False
    """Whether a question was asked, in this run or one before."""
    made: dict[int, int] = field(default_factory=dict)
    """The chosen options by the numbers of the choices."""
    solution: Moves | None = None
    """The moves of the solution while it is shown."""
    early: list[int] = field(default_factory=list)
    """Options that were typed before the choices they are for were asked."""
    asks: bool = True
    """Whether the run asks at its next choice."""
    reached: str | None = None
    """What reached the goal, as a sentence; "" if there is nothing to tell, None if nothing has."""

    def set_up(self, subject: ShownProgram, speed: float | None) -> RunSetup:
        """Return the set-up of a run that repeats the choices so far, and asks from then on."""
        return msgspec.structs.replace(subject.set_up(None, speed), seed=moves_text(self.made, "ask"))

    @property
    def moves(self) -> int:
        """The number of choices of another thread than the one that would go on by itself."""
        return sum(option > 0 for option in self.made.values())

    def take(self, events: Iterable[AnyEvent]) -> None:
        """Receive events of the run, questions among them."""
        for event in events:
            if isinstance(event, ChoiceAsked):
                self.question, self.was_asked = event, True
                self.check_goal()
                if self.early and self.question is not None:
                    self.choose(self.early.pop(0))

    def check_goal(self) -> None:
        """Check whether the goal is reached; then the run goes on to its end without questions."""
        puzzle, run = self.puzzle, self.runs.run
        if puzzle is None or self.reached is not None or (self.question is None and run.alive):
            return
        verdict = puzzle.goal.check().judge(run.timeline)
        if verdict.passed:
            self.reached = "" if puzzle.goal.says else f" {verdict.seen}."
            if self.solution is None:
                self.host.console.progress.passes(puzzle.id)
            if self.question is not None:
                self.action_resume()

    @property
    def sheet(self) -> ChoiceSheet:
        """Return the content of the pane."""
        puzzle, question = self.puzzle, self.question
        task = _MOVE if puzzle is None else f"{puzzle.task} {_MOVE}"
        if self.reached is not None and puzzle is not None:
            done = f"✓ Done in {counted(self.moves, 'move')}; the solution takes {len(solution_of(puzzle))}."
            return ChoiceSheet(f"{done}{self.reached}", task, is_over=True)
        if question is not None:
            advised = None if self.solution is None else self.solution.get(question.number, 0)
            asks = "Who goes on?" if advised is None else f"The solution chooses {advised + 1}."
            return ChoiceSheet(
                f"Choice {len(self.made) + 1}, {counted(self.moves, 'move')}. {asks}",
                task,
                tuple(options_of(question, self.runs.timeline)),
                tuple(kept_of(question, self.runs.timeline)),
                advised,
            )
        if self.runs.run.alive:
            return ChoiceSheet("The run goes on …", task)
        if puzzle is None:
            return ChoiceSheet("The run is over.", task, is_over=True)
        undo, again = self.host.key("undo"), self.host.key("run_again")
        missed = f"✗ Not this time. {undo} takes a choice back, {again} begins again."
        return ChoiceSheet(missed, task, is_over=True)

    def choose(self, option: int) -> None:
        """Let the thread of an option go on; before the next choice is asked, keep the option for that."""
        if self.question is None and self.asks and self.runs.run.alive:
            self.early += [option][: _EARLY - len(self.early)]
        elif self.question is None or option >= len(self.question.threads):
            self.early.clear()
            none = f"There is no thread {option + 1} to choose now."
            over = f"The run is over: {self.host.key('run_again')} begins again."
            self.host.tell(none if self.runs.run.alive else over)
        else:
            self.made[self.question.number] = option
            self.question = None
            self.runs.run.choose(option)
            self.host.redraw()

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer to take back, resume and solve where that is possible."""
        match action:
            case "undo":
                return bool(self.made)
            case "resume":
                return self.question is not None
            case "solution" | "lesson":
                return self.puzzle is not None
        return True

    async def action_undo(self) -> None:
        """Take the last choice back."""
        if self.early and self.runs.run.alive:
            self.early.pop()
        elif self.made:
            self.made.popitem()
            await self._run_again()

    async def action_run_again(self) -> None:
        """Begin again."""
        self.made.clear()
        self.solution = None
        await self._run_again()

    async def action_solution(self) -> None:
        """Begin again, and show the solution's option at each choice."""
        if self.puzzle is not None:
            self.host.console.progress.look_at_solution(self.puzzle.id)
            self.made.clear()
            self.solution = solution_of(self.puzzle)
            await self._run_again()

    async def _run_again(self) -> None:
        self.question, self.reached, self.asks = None, None, True
        self.early.clear()
        await self.restarts.start(Changes(), speed=None)

    def action_resume(self) -> None:
        """Let the run go on without questions."""
        self.question, self.asks = None, False
        self.early.clear()
        self.runs.run.resume()
        self.host.redraw()

    def action_lesson(self) -> None:
        """Open the lesson that the puzzle belongs to."""
        if self.puzzle is not None:
            self.host.console.open_lesson(find(self.puzzle.lesson))


def solution_of(puzzle: Puzzle) -> Moves:
    """Return the moves of a puzzle's solution."""
    return moves_of(puzzle.solution)


@dataclass
class TakeOver(ScreenPart):
    """Lets the learner schedule the threads of a run from the moment at which it is paused.

    Another run is made up to that moment, and ``open_choosing`` opens it; the run on screen stays as it is.
    """

    host: RunHost
    runs: RunController[LiveRun]
    subject: ShownProgram
    open_choosing: Callable[[ShownProgram], object]

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer it on a paused run in the usual order of threads, and the reason on others."""
        run = self.runs.run
        return (run.can_step and not run.setup.seed) is (action == "take_over")

    def action_no_take_over(self) -> None:
        """Tell what it takes."""
        run, pause = self.runs.run, self.host.key("pause")
        if not run.virtual:
            told = "Choosing who goes on needs virtual time: cbtui open FILE.py --clock virtual."
        elif run.setup.seed:
            told = "In this run the order of the threads is chosen already."
        elif not run.alive:
            told = f"The run is over: run it again, and pause it with {pause} where you want to choose."
        else:
            told = f"Pause the run with {pause} first: from that moment on you choose who goes on."
        self.host.tell(told)

    def action_take_over(self) -> None:
        """Open the screen for choosing."""
        run = self.runs.run
        events = chain.from_iterable(run.material().batches())
        self.open_choosing(of_moment(self.subject, run.setup, events, run.timeline.end))
