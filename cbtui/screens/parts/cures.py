"""Tries cures of findings in the background, and compares a run with a cure to the one before."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain, islice, takewhile
from pathlib import Path
from threading import Event, Lock

from cbtui.engines.follow import GivenUpError
from cbtui.runs.judged.cures import (
    Cure,
    Problem,
    TriedRun,
    Verdict,
    both,
    cures_of,
    judged,
    problem_of,
    text_of,
    try_run,
    with_inputs,
)
from cbtui.runs.live.findings import ExplainedFinding
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.setup.changeable import changeable
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.equivalent_code import code_of_cure
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.parts.restarts import Restarts
from cbtui.screens.parts.runs import RunController
from cbtui.text.changed_lines import changed_lines
from sim.engine.inputs import UnknownInputError, inputs_of, stops
from sim.engine.setup import TimedInput
from sim.quantities.nanoseconds import SECOND
from sim.trace.model import Nanoseconds

_SHORTEST: Nanoseconds = 5 * SECOND
_LONGEST: Nanoseconds = 40 * SECOND
_LONGEST_REAL: Nanoseconds = 8 * SECOND
_SHOWS: Nanoseconds = 3 * SECOND
"""How long a trial goes on after now: on virtual time a wait is told later than on the real clock."""
_COMES_SOON: Nanoseconds = 10 * SECOND
"""A timer of at most this period, which may be what a cure lets run, is called once in all that time."""

_PAIRS = 6
"""How many pairs of cures are tried of which none helps alone."""
_ONLY_ON_MODEL = "Cures are tried only on the model: open the program without --on ros2 to have them tried."

Note = Callable[[int], object]
"""Receives the progress of a trial in per cent."""


@dataclass
class CureTrials:
    """Tries cures of findings; ``compare`` compares with the run before."""

    runs: RunController[LiveRun]
    restarts: Restarts
    subject: ShownProgram
    compare: Callable[[], None]
    _latest: "CureTrial | None" = None

    def begin(self) -> "CureTrial":
        """Return a trial of cures for the run on screen so far, or that which was begun for it before."""
        latest = self._latest
        if latest is None or latest.run is not self.runs.run or latest.changes != self.restarts.changes:
            self.leave()
            latest = self._latest = self._anew()
        return latest

    def leave(self) -> None:
        """Give up the trial that was begun; for the end of the screen, too."""
        if self._latest is not None:
            self._latest.given_up.set()

    def _anew(self) -> "CureTrial":
        return CureTrial(self, self.runs.run, self.restarts.changes, self.until())

    def until(self) -> Nanoseconds:
        """Return the moment up to which a trial runs that begins now."""
        timeline = self.runs.timeline
        periods = (each.period for each in timeline.entities.values() if each.period <= _COMES_SOON)
        return min(max(timeline.end + max(_SHOWS, *periods, 0), _SHORTEST), _LONGEST)

    async def run(self, cure: Cure) -> None:
        """Run again with a cure and the same inputs, and compare with the run before."""
        self.leave()
        texts = self.restarts.changes.texts
        edits = (
            changed_lines(texts.get(file) or text_of(Path(file)), text)
            for file, text in cure.changes.texts.items()
        )
        await self.restarts.again(cure.changes, self._anew().inputs, ", ".join(filter(None, edits)))
        self.compare()


@dataclass
class CureTrial:
    """Tries several cures of a run up to a moment.

    What it has found out it keeps, so that it can be asked again. ``given_up`` ends what it tries.
    """

    trials: CureTrials
    run: LiveRun
    changes: Changes
    until: Nanoseconds
    given_up: Event = field(default_factory=Event)
    _trying: Lock = field(default_factory=Lock)
    _note: Note = lambda _: None
    _before: dict[str, TriedRun] = field(default_factory=dict)
    """The runs without a cure, by the clock."""
    _verdicts: dict[tuple[Problem, str], Verdict] = field(default_factory=dict)
    _pairs: dict[Problem, list[Cure]] = field(default_factory=dict)
    """Cures that did not help, each with one of what was left."""
    _offered: dict[Problem, tuple[frozenset[str], Callable[[Cure], Cure]]] = field(default_factory=dict)
    """The keys of the cures of each problem, and what adds its code to one."""

    @property
    def refusal(self) -> str:
        """A sentence on why no cure of this run is tried; "" if cures are tried."""
        return _ONLY_ON_MODEL if self.run.setup.real is not None else ""

    def cures(self, found: ExplainedFinding) -> tuple[Cure, ...]:
        """Return the cures of a finding that can be tried: only for problems, and only on the model."""
        if not found.is_problem or self.refusal:
            return ()
        timeline, source = self.run.timeline, text_of(self.trials.subject.node_path)
        about = changeable(self.trials.subject, self.run.setup, timeline)

        def with_code(cure: Cure) -> Cure:
            return replace(cure, code=tuple(code_of_cure(cure.changes.without(self.changes), about, source)))

        offered = tuple(map(with_code, cures_of(found.explanation, self.changes, timeline)))
        self._offered[problem_of(found.finding, timeline)] = (
            frozenset(each.key for each in offered),
            with_code,
        )
        return offered

    def judge(self, found: ExplainedFinding, cure: Cure, note: Note = lambda _: None) -> Verdict:
        """Tell whether a cure ends a finding; takes two runs, for further cures of a finding one.

        Who asks while another thread does waits for that one, and is told the progress in its place.
        If none of its cures helps alone, the verdict on the last one is on pairs of them, too.
        Unknown if the run without a cure does not show the finding in time: then no cure is tried. What a run
        on the real clock shows, and one on virtual time does not, such as a long computation, is tried on the
        real clock too.
        """
        problem = problem_of(found.finding, self.run.timeline)
        self._note = note
        with self._trying:
            if (known := self._verdicts.get((problem, cure.key))) is not None:
                return known
            verdict = Verdict(None)
            with suppress(GivenUpError, OSError, UnknownInputError):
                for clock in ("virtual", "real") if self.run.timeline.is_real else ("virtual",):
                    verdict = self._judged(problem, cure, clock)
                    if verdict.helps is not None:
                        break
                if verdict.helps is False and clock == "virtual":
                    verdict = self._with_pairs(problem, cure, verdict)
                if verdict != Verdict(None):
                    self._verdicts[problem, cure.key] = verdict
            return verdict

    def _judged(self, problem: Problem, cure: Cure, clock: str) -> Verdict:
        before = self._without(problem, clock)
        if problem not in before.problems:
            return Verdict(None)
        after = self._try(cure.changes, clock, 50)
        verdict = judged(problem, before, after, again=cure.again)
        self._pairs.setdefault(problem, []).extend(
            both(cure, each, self.changes) for each in after.next_cures[:2]
        )
        return verdict

    def _with_pairs(self, problem: Problem, cure: Cure, verdict: Verdict) -> Verdict:
        """Judge pairs if a cure is the last of those offered, and none of these helps."""
        keys, with_code = self._offered.get(problem, (frozenset[str](), None))
        others = [self._verdicts.get((problem, each)) for each in keys - {cure.key}]
        if with_code is None or not all(each is not None and each.helps is False for each in others):
            return verdict
        pairs = islice(self._pairs[problem], _PAIRS)
        helpful = (each for each in pairs if self._judged(problem, each, "virtual").helps)
        pair = next(helpful, None)
        return verdict if pair is None else Verdict(True, both=with_code(pair))

    def _without(self, problem: Problem, clock: str) -> TriedRun:
        """Return the run without a cure; another one up to now, if none before shows a problem.

        The problem may have come about since the trial began, as while the window is open.
        """
        before, now = self._before.get(clock), self.trials.until()
        if (before is None or problem not in before.problems) and now > self.until:
            self.until, before = now, None
            self._before.clear()
            vars(self).pop("inputs", None)
        if before is None:
            before = self._before[clock] = self._try(self.changes, clock)
        return before

    @cached_property
    def inputs(self) -> tuple[TimedInput, ...]:
        """Return the inputs that the run got from outside."""
        events = chain.from_iterable(self.run.material().batches())
        given = inputs_of(takewhile(lambda event: event.t <= self.until, events))
        return tuple(each for each in given if not stops(each))

    def _try(self, changes: Changes, clock: str, done: int = 0) -> TriedRun:
        """Make the half of the trial's work that follows when so much per cent is done."""
        setup = changes.applied(self.trials.subject.set_up(changes.threads, None))
        until = self.until if clock == "virtual" else min(self.until, _LONGEST_REAL)
        return try_run(
            with_inputs(setup, self.inputs),
            until,
            self.given_up,
            lambda end: self._note(done + 50 * end // until),
            clock=clock,
            changes=changes,
        )
