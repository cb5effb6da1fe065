"""A lesson or a file in lines, with the commands of its engine."""

import asyncio
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from threading import Thread
from typing import TypeAlias

from cbtui.engines.session import Deliver, Ended, OpenSession
from cbtui.learning.lesson_page import PageSection, introduction
from cbtui.learning.outcome import Observe
from cbtui.runs.judged.compared_problems import ComparedProblems
from cbtui.runs.judged.cures import Cure, Verdict, tried_in_vain
from cbtui.runs.live.findings import ExplainedFinding
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.linear.asking import AskedSetUp, FinishInLines
from cbtui.screens.linear.choosing import ChoosingConsole
from cbtui.screens.linear.console import LinearConsole, LineTerminal
from cbtui.screens.linear.dialogue import Dialogue
from cbtui.screens.linear.exercise import ExerciseInLines
from cbtui.screens.linear.teaching import Teaching
from cbtui.screens.parts.choices import TakeOver
from cbtui.screens.parts.cures import CureTrial, CureTrials
from cbtui.screens.parts.engine_keys import PaceKeys, RecordingKey, TimeRefusals, WorldKeys
from cbtui.screens.parts.keys import Refusals
from cbtui.screens.parts.part import ScreenPart
from cbtui.screens.parts.restarts import Restarts
from lessons.lesson import Lesson
from sim.quantities.durations import timestamp
from sim.quantities.nanoseconds import SECOND
from sim.trace.figures.comparison import compare, first_difference
from sim.trace.figures.comparison_text import comparison_lines
from sim.trace.incremental import run_to_end
from sim.trace.model import Nanoseconds, Window

_COMPARED: Nanoseconds = 10 * SECOND
"""Length of a run from which on it is compared, unless the one before was shorter."""


class LessonConsole(LinearConsole[LiveRun]):
    """Runs a program; a lesson asks for predictions before its run and explains them after it.

    ``observe`` runs the lesson that explains the predictions.
    """

    def __init__(
        self,
        terminal: LineTerminal,
        subject: ShownProgram,
        changes: Changes,
        open_session: OpenSession,
        observe: Observe,
        with_exercise: bool = False,
    ) -> None:
        super().__init__(terminal, subject, self._make_run, live=lambda: self.runs.run)
        self._open_session = open_session
        runs, lesson, following = self.runs, subject.lesson, subject.following
        self.restarts = Restarts(self, runs, changes, self.show_new_run, speed=lambda: runs.run.speed)
        self._comparison = LinearComparison(self, self.restarts)
        trials = CureTrials(runs, self.restarts, subject, self._comparison.action_compare)
        self._cures = CuresByNumber(self, trials)
        self._teaching = None if lesson is None else self._teaching_of(lesson, observe)
        take_over = TakeOver(self, runs, subject, self._open_choosing)
        keys = (PaceKeys(self, runs), WorldKeys(self, runs), TypedLines(self), self.restarts, take_over)
        exercise = None if lesson is None else ExerciseInLines(self, lesson, self.progress)
        self._opening_exercise = exercise if with_exercise else None
        recording = RecordingKey(self, runs, FinishInLines(self))
        refusals = Refusals(self, lesson, self._is_available)
        of_time = TimeRefusals(self, runs, self._is_available)
        set_up = AskedSetUp(self, runs, self.restarts, subject)
        own = (self._comparison, self._cures, self._teaching, exercise, set_up, recording, refusals, of_time)
        more = filter(None, own)
        on = {} if following is None else {"next_lesson": partial(self.open_lesson, following)}
        self.add_parts(*keys, *more, **on)
        runs.begin(1.0)
        self.telling.begin()

    def _is_available(self, action: str) -> bool:
        return self._parts.offer(action, ())

    def _teaching_of(self, lesson: Lesson, observe: Observe) -> Teaching:
        teaching = Teaching(
            self,
            lesson,
            observe,
            lambda outcome: self.post(lambda: teaching.tell_explanation(outcome)),
            lambda: self.runs.run.setup.real,
            self.progress,
        )
        return teaching

    def _make_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        return LiveRun(self.restarts.set_up(self.subject, speed), self._open_session, deliver, ended)

    def _open_choosing(self, subject: ShownProgram) -> None:
        """Let the learner schedule the threads, and return to this run."""
        ChoosingConsole(self.terminal, subject, self._open_session).run()
        self.tell(f"back to {self.subject.heading}")

    def run(self) -> Lesson | None:
        """Run until the user leaves, and end the trials of cures."""
        try:
            return super().run()
        finally:
            self._cures.trials.leave()

    def greet(self) -> Dialogue:
        """Print what is run, ask for predictions, and start it."""
        teaching = self._teaching
        self.tell_page(introduction(self.subject.guide) or f"# {self.subject.heading}")
        if teaching is not None:
            changed = bool(replace(self.restarts.changes, real=None).words)
            if teaching.can_predict and not changed and self._opening_exercise is None:
                yield from teaching.predict()
            self.tell_page(teaching.lesson.task or "")
            teaching.tell_page(PageSection.GUIDE)
        self.tell(self.runs.run.start())
        self.tell("The run begins. ? tells the keys, q leaves.")
        if self._opening_exercise is not None:
            self._opening_exercise.action_exercise()

    def turn(self) -> None:
        """Print the news, and the comparison if it is due."""
        super().turn()
        self._comparison.tell_when_due()


@dataclass
class TypedLines(ScreenPart):
    """Asks for ``ros2`` lines, input of the program, and a number of threads."""

    host: LessonConsole

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer what the run accepts."""
        run = self.host.runs.run
        return {"prompt": run.alive, "type": run.asked is not None}.get(action, bool(run.setup.programs))

    def action_prompt(self) -> None:
        """Ask for a line, or the label of a key."""
        self.host.ask(self._ask("Line:", lambda line: self.host.post(lambda: self.host.carry_out(line))))

    def action_type(self) -> None:
        """Ask for a line for the program that reads."""
        self.host.ask(self._ask("For the program:", lambda line: self.host.runs.run.type(f"{line}\n")))

    def action_threads(self) -> None:
        """Ask for a number of threads, and restart the run."""
        asked = "How many threads should the executor have? Nothing for the program's own:"
        self.host.ask(self._ask(asked, self._take_threads))

    def _ask(self, question: str, take: Callable[[str], object]) -> Dialogue:
        take((yield question))

    def _take_threads(self, line: str) -> None:
        if line and not (line.isdecimal() and 0 < int(line) <= 64):
            self.host.tell("That is not a number of threads.")
            return
        restarts = self.host.restarts
        changes = replace(restarts.changes, threads=int(line) if line else None)
        asyncio.run(restarts.again(changes))


@dataclass
class LinearComparison(ScreenPart):
    """Prints what differs from the run before, once the new one is long enough."""

    host: LessonConsole
    restarts: Restarts
    _due: Nanoseconds | None = None

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer it from the second run on."""
        return self.restarts.both is not None

    def action_compare(self) -> None:
        """Print it now, or when it is due."""
        if self.restarts.before is not None:
            self._due = min(self.restarts.before.timeline.end, _COMPARED)
            self.tell_when_due()
            if self._due is not None:
                self.host.tell(f"The comparison comes when this run has reached {timestamp(self._due)}.")

    def tell_when_due(self) -> None:
        """Print the requested comparison if the run is long enough."""
        run, both = self.host.runs.run, self.restarts.both
        if self._due is None or both is None or (run.alive and run.timeline.end < self._due):
            return
        self._due = None
        first, second = (side.timeline for side in both)
        window = Window(0, min(first.end, second.end))
        compared, problems = compare(first, second, window), ComparedProblems(first, second).compared()
        for line in comparison_lines(compared, both[0].name, both[1].name, problems):
            self.host.tell(line)
        at = run_to_end(first_difference(first, second, window))
        self.host.tell("no call differs" if at is None else f"they differ from {timestamp(at)}")


@dataclass
class CuresByNumber(ScreenPart):
    """Prints the diagnoses, and tries the cure of one in the background; one that helps restarts the run."""

    host: LessonConsole
    trials: CureTrials

    def action_diagnoses(self) -> None:
        """Print the findings, and ask which cure to try."""
        self.host.telling.action_diagnoses()
        trial = self.trials.begin()
        cures = {
            str(place): (found, offered)
            for place, found in enumerate(self.host.runs.findings.findings, 1)
            if (offered := trial.cures(found))
        }
        if cures:
            self.host.ask(self._choose(trial, cures))
        elif any(each.is_problem for each in self.host.runs.findings.findings):
            self.host.tell(trial.refusal or None)

    def _choose(self, trial: CureTrial, cures: Mapping[str, "_Tried"]) -> Dialogue:
        number = self.host.runs.number
        line = yield f"Type the number of a problem to try its cure ({', '.join(cures)}), or nothing:"
        if line not in cures:
            self.host.tell(f"The cure of {line} cannot be tried." if line else None)
            return
        found, offered = cures[line]
        for cure in offered:
            self.host.tell(f"It is tried in the background: {cure.words}.")

        def try_out() -> None:
            tried: list[tuple[Cure, Verdict]] = []
            for each in offered:
                verdict = trial.judge(found, each)
                tried.append((verdict.both or each, verdict))
                if verdict.helps:
                    break
            self.host.post(
                lambda: self._take_verdict(found, tried) if self.host.runs.number == number else None
            )

        Thread(target=try_out, name="cure", daemon=True).start()

    def _take_verdict(self, found: ExplainedFinding, tried: Sequence[tuple[Cure, Verdict]]) -> None:
        """Tell which of the cures helps, the last one that was tried if any, and run again with it."""
        helpful, verdict = tried[-1]
        if not verdict.helps:
            self.host.tell(tried_in_vain(tried))
            return
        self.host.tell(f"Tried, it helps: {helpful.words}. With that there is no {found.name} any more.")
        self.host.tell(f"Another problem comes: {verdict.instead}." if verdict.instead else None)
        self.host.tell("To have this in the file, write:" if helpful.code else None)
        for line in "\n".join(filter(None, [helpful.diff, *helpful.code])).splitlines():
            self.host.tell(line)
        asyncio.run(self.trials.run(helpful))


_Tried: TypeAlias = tuple[ExplainedFinding, tuple[Cure, ...]]
"""A problem, and its cures that can be tried."""
