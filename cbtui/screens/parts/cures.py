"""Trying the cure of a finding: out of sight whether it helps, and then beside the run as it was."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, takewhile
from threading import Event

from cbtui.engines.follow import GivenUpError
from cbtui.runs.judged.cures import Problems, changes_of, helps, problem_of, problems_in, with_inputs
from cbtui.runs.live.findings import ExplainedFinding
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.parts.restarts import Restarts
from cbtui.screens.parts.runs import RunController
from sim.engine.inputs import UnknownInputError, inputs_of, stops
from sim.engine.setup import TimedInput
from sim.trace.model import Nanoseconds
from sim.units import SECOND

_SHORTEST: Nanoseconds = 5 * SECOND
_LONGEST: Nanoseconds = 40 * SECOND

Note = Callable[[int], object]
"""Takes how many per cent of a trial are done."""


@dataclass
class CureTrials:
    """Tries cures that need no edit of the program; ``compare`` compares with the run before."""

    runs: RunController[LiveRun]
    restarts: Restarts
    subject: ShownProgram
    compare: Callable[[], None]

    def can_try(self, told: ExplainedFinding) -> bool:
        """Whether a finding's cure can be tried out of sight."""
        on_model = self.restarts.changes.real is None
        return told.is_problem and on_model and self._changes_for(told) is not None

    def begin(self) -> "CureTrial":
        """Return a trial of cures of the run on screen, as far as it has come."""
        until = min(max(self.runs.timeline.end, _SHORTEST), _LONGEST)
        return CureTrial(self, self.runs.run, self.restarts.changes, until)

    async def run(self, told: ExplainedFinding) -> None:
        """Run again with a finding's cure and the same inputs, and compare with the run before."""
        changes = self._changes_for(told)
        if changes is not None:
            await self.restarts.again(changes, self.begin().inputs)
            self.compare()

    def _changes_for(self, told: ExplainedFinding) -> Changes | None:
        return changes_of(told.explanation.remedy, self.restarts.changes, self.runs.timeline)


@dataclass
class CureTrial:
    """Tries several cures of a run up to a moment; used on one thread, which may be another."""

    trials: CureTrials
    run: LiveRun
    changes: Changes
    until: Nanoseconds
    _tried: tuple[Problems | None] | None = None

    def helps(self, told: ExplainedFinding, given_up: Event, note: Note = lambda _: None) -> bool:
        """Whether a finding's cure ends it; takes the time of two runs, for further cures of one.

        A run that does not come to its end in time tells nothing; then no cure is tried on it.
        """
        if not self.trials.can_try(told):
            return False
        timeline = self.run.timeline
        cured = changes_of(told.explanation.remedy, self.changes, timeline)
        assert cured is not None
        try:
            if self._tried is None:
                self._tried = (self._problems(self.changes, given_up, lambda done: note(done // 2)),)
            if self._tried[0] is None:
                return False
            after = self._problems(cured, given_up, lambda done: note(50 + done // 2))
            return helps(problem_of(told.finding, timeline), self._tried[0], after)
        except (GivenUpError, OSError, UnknownInputError):
            return False

    @cached_property
    def inputs(self) -> tuple[TimedInput, ...]:
        """What was told to the run from outside."""
        events = chain.from_iterable(self.run.material().source.batches())
        given = inputs_of(takewhile(lambda event: event.t <= self.until, events))
        return tuple(each for each in given if not stops(each))

    def _problems(self, changes: Changes, given_up: Event, note: Note) -> Problems | None:
        setup = changes.applied(self.trials.subject.set_up(changes.threads, None))
        until = self.until
        return problems_in(
            with_inputs(setup, self.inputs), until, given_up, lambda end: note(100 * end // until)
        )
