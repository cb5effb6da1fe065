"""Trying the cure of a finding: out of sight whether it helps, and then beside the run as it was."""

from collections.abc import Callable
from dataclasses import dataclass
from threading import Event

from cbtui.engines.follow import GivenUpError
from cbtui.runs.judged.cures import changes_of, helps, problem_of
from cbtui.runs.live.findings import ExplainedFinding
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.parts.restarts import Restarts
from cbtui.screens.parts.runs import RunController
from sim.engine.setup import RunSetup
from sim.trace.model import Nanoseconds
from sim.units import SECOND

_SHORTEST: Nanoseconds = 5 * SECOND
_LONGEST: Nanoseconds = 20 * SECOND


@dataclass
class CureTrials:
    """Tries cures that need no edit of the program.

    ``compare`` compares with the run before. What a person did to the run, such as calls of services, is not
    repeated out of sight: of such a run no cure is tried.
    """

    runs: RunController[LiveRun]
    restarts: Restarts
    subject: ShownProgram
    compare: Callable[[], None]

    def can_try(self, told: ExplainedFinding) -> bool:
        """Whether a finding's cure can be tried out of sight."""
        asked = any(call.caller == 0 for call in self.runs.timeline.calls)
        on_model = self.restarts.changes.real is None
        return told.is_problem and on_model and not asked and self._changes_for(told) is not None

    def helps(self, told: ExplainedFinding, given_up: Event) -> bool:
        """Whether a finding's cure ends it; takes the time of two runs, on the caller's thread."""
        timeline, before = self.runs.timeline, self.restarts.changes
        changes = self._changes_for(told)
        if changes is None or not self.can_try(told):
            return False
        until = min(max(timeline.end, _SHORTEST), _LONGEST)
        problem = problem_of(told.finding, timeline)
        try:
            return helps(problem, self._set_up(before), self._set_up(changes), until, given_up)
        except (GivenUpError, OSError):
            return False

    async def run(self, told: ExplainedFinding) -> None:
        """Run again with a finding's cure, and compare with the run before."""
        changes = self._changes_for(told)
        if changes is not None:
            await self.restarts.again(changes)
            self.compare()

    def _changes_for(self, told: ExplainedFinding) -> Changes | None:
        return changes_of(told.explanation.remedy, self.restarts.changes, self.runs.timeline)

    def _set_up(self, changes: Changes) -> RunSetup:
        return changes.applied(self.subject.set_up(changes.threads, None))
