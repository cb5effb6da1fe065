"""A run with one or many thread schedules, and the assertions that a test can make on it."""

import argparse
import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NoReturn, Self

import pytest

from cbtui.commands.options import values
from cbtui.pytest_plugin.failure_report import Recordings, lanes_text, print_log
from cbtui.runs.judged.check_text import verdict_line
from cbtui.runs.judged.checking import ObservedRun
from cbtui.runs.judged.schedule_text import conflict_text
from lessons import checks
from lessons.checks import Check, Stretch
from lessons.checks.reading import entities_named
from lessons.judge import Judge, JudgedCheck
from lessons.lesson import Lesson
from sim.clock.schedule import Seed
from sim.diagnosis import findings_text
from sim.engine.setup import RunSetup
from sim.quantities.plural import counted
from sim.trace.events import AnyEvent, encode
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

__tracebackhide__ = True

_NOT_SO = "not so in {}, this one is --cbtui-seed {}"
_FAILS = (
    "the program itself fails in {}, this one is --cbtui-seed {}; "
    "what is asked of the run after this was not looked at"
)


@dataclass(frozen=True)
class Outcome:
    """The outcome of one schedule; ``events`` are empty if they were not kept."""

    seed: Seed
    observed: ObservedRun
    events: Sequence[AnyEvent] = field(default=(), repr=False)


class CheckedRun:
    """A finished run. Each assertion is about every schedule; the first that violates it fails the test.

    The assertions return the run itself, so that they can be chained.
    """

    def __init__(
        self,
        outcomes: Sequence[Outcome],
        setup: RunSetup,
        lesson: Lesson | None,
        again: Callable[[Seed], Outcome],
        recordings: Recordings,
    ) -> None:
        self._outcomes = outcomes
        self._setup = setup
        self._lesson = lesson
        self._again = again
        self._recordings = recordings

    @property
    def timeline(self) -> Timeline:
        """The timeline of the run, that of the first schedule if there are several."""
        return self._outcomes[0].observed.timeline

    @property
    def timelines(self) -> Sequence[Timeline]:
        """The timelines of all schedules."""
        return [each.observed.timeline for each in self._outcomes]

    @property
    def trouble(self) -> str | None:
        """A sentence on why the program failed; None if it did not."""
        return next((each.observed.trouble for each in self._outcomes if each.observed.trouble), None)

    @cached_property
    def digest(self) -> str:
        """A digest of all events of the first schedule; on virtual time equal runs have equal digests."""
        first = self._outcomes[0]
        events = first.events or self._again(first.seed).events
        packed = hashlib.sha256()
        for event in events:
            packed.update(encode([event]))
        return packed.hexdigest()

    def callback(self, name: str) -> "AskedCallback":
        """Return a callback by the name of its function, topic or service: ``odom_callback``, ``/odom``."""
        return AskedCallback(self.has_callbacks(name), name)

    def service(self, name: str) -> "AskedService":
        """Return a service by its name: ``/motor_power``."""
        return AskedService(self.has_callbacks(name), name)

    def chain(self, *names: str) -> "AskedChain":
        """Return the chain of messages from a first topic to a last one; those between may be named, too."""
        try:
            return AskedChain(self, values.chain(":".join(names)))
        except argparse.ArgumentTypeError as error:
            raise pytest.UsageError(str(error)) from None

    def passes(self, *asked: Check) -> Self:
        """Assert any checks, such as those of ``lessons.checks``."""
        for check in asked:
            self._ask(check)
        return self

    def passes_its_checks(self) -> Self:
        """Assert the checks of the lesson that was run."""
        if self._lesson is None:
            raise ValueError(
                "only a lesson has checks of its own; name one in cbtui('split-groups', 'mine.py')"
            )
        return self.passes(*Judge(self._lesson).checks)

    def ends_well(self) -> Self:
        """The program neither raises nor is broken off."""
        failed = [each for each in self._outcomes if each.observed.trouble is not None]
        for each in failed[:1]:
            self._fail(each, str(each.observed.trouble), each.observed.timeline.end, len(failed), _FAILS)
        return self

    def has_callbacks(self, *names: str) -> Self:
        """There are callbacks, topics or services of these names, called or not, in one schedule at least."""
        for name in names:
            if not any(entities_named(timeline, name) for timeline in self.timelines):
                there = {each.spoken_name: None for each in self.timeline.entities.values()}
                known = f"callbacks: {', '.join(there)}" if there else "the run has no callback at all"
                sentence = f"no callback, topic or service is named {name}; {known}"
                self._fail(self._outcomes[0], sentence, None, len(self._outcomes))
        return self

    def has_no_deadlock(self) -> Self:
        """No callback waits for what can never come, and no threads for each other's locks."""
        return self.passes(checks.never_stuck())

    def has_no_problem(self, rule: str | None = None) -> Self:
        """The diagnosis finds no problem: none at all, or none of a rule such as ``group-starvation``."""
        return self.passes(checks.no_problems() if rule is None else checks.no_problem(rule))

    def never_raises(self) -> Self:
        """No callback ends with an exception."""
        return self.passes(checks.never_raises())

    def begins_in_order(self, *callbacks: str) -> Self:
        """All of these callbacks are called, for the first time in this order."""
        return self.has_callbacks(*callbacks).passes(checks.begin_in_order(*callbacks))

    def never_overlaps(self, *callbacks: str) -> Self:
        """No two calls of these callbacks run at the same time."""
        return self.has_callbacks(*callbacks).passes(checks.never_overlap(*callbacks))

    def keeps_its_groups(self) -> Self:
        """No two callbacks of one mutually exclusive group run at the same time."""
        return self.passes(checks.exclusive_groups_hold())

    def uses_threads(self, at_least: int) -> Self:
        """At some moment callbacks run on ``at_least`` threads."""
        return self.passes(checks.uses_threads(at_least))

    def answers_every_call(self) -> Self:
        """Every service call gets its answer, and its caller takes it; there is at least one."""
        return self.passes(checks.every_call_answered())

    def logs(self, text: str, at_least: int = 1) -> Self:
        """The log has lines with a text in them."""
        return self.passes(checks.log_says(text, at_least))

    def never_logs(self, text: str) -> Self:
        """No line of the log has a text in it."""
        return self.passes(checks.log_never_says(text))

    def _ask(self, check: Check) -> None:
        judged = [(each, check.judge(each.observed.timeline)) for each in self._outcomes]
        failed = [(each, verdict) for each, verdict in judged if not verdict.passed]
        for outcome, verdict in failed[:1]:
            said = f"not so: {check.asks}\n{verdict_line(JudgedCheck(check, verdict))}"
            self._fail(outcome, said, verdict.at, len(failed))

    def _fail(
        self, outcome: Outcome, said: str, at: Nanoseconds | None, failed: int, counted_so: str = _NOT_SO
    ) -> NoReturn:
        kept = outcome if outcome.events else self._again(outcome.seed)
        lines = [said]
        if self._setup.clock == "virtual":
            of = len(self._outcomes)
            which = counted_so.format(f"{failed} of {counted(of, 'schedule')}", outcome.seed)
            if of == 1:
                order = "order of threads:" if outcome.seed else "the usual order of threads,"
                which = f"{order} --cbtui-seed {outcome.seed}"
            lines.append(which)
        lines.append(self._recordings.keep(self._setup, outcome.seed, kept.events))
        print_log(kept.events, at)
        timeline = outcome.observed.timeline
        lines += (f"conflict: {conflict_text(each, timeline)}" for each in timeline.conflicts)
        lines += ["", *lanes_text(timeline, at)]
        lines += ["", *findings_text(checks.problems(timeline), timeline).splitlines()]
        raise AssertionError("\n".join(lines).rstrip())


@dataclass(frozen=True)
class AskedCallback:
    """The assertions on one callback; each method returns the run."""

    run: CheckedRun
    name: str

    def is_called(
        self, at_least: int = 1, *, at_most: int | None = None, exactly: int | None = None
    ) -> CheckedRun:
        """It is called ``exactly`` so often, or between ``at_least`` and ``at_most`` times."""
        least, most = (at_least, at_most) if exactly is None else (exactly, exactly)
        return self.run.passes(checks.is_called_between(self.name, least, most))

    def is_never_called(self) -> CheckedRun:
        """It is not called at all."""
        return self.run.passes(checks.is_called_between(self.name, 0, 0))

    def keeps_coming(self, at_least: float, *, while_: Stretch | None = None) -> CheckedRun:
        """It is called ``at_least`` times a second, always or during a stretch of ``lessons.checks``."""
        return self.run.passes(checks.keeps_coming(self.name, while_ or checks.WHOLE_RUN, at_least))

    def never_waits_longer_than(self, seconds: float) -> CheckedRun:
        """Once it is ready it runs within ``seconds``."""
        return self.run.passes(checks.never_waits_longer_than(self.name, seconds))

    def never_runs_longer_than(self, seconds: float) -> CheckedRun:
        """None of its calls takes longer."""
        return self.run.passes(checks.never_runs_longer_than(self.name, seconds))

    def never_takes_older_than(self, seconds: float) -> CheckedRun:
        """None of the messages that it gets is older."""
        return self.run.passes(checks.never_takes_older_than(self.name, seconds))

    def never_decides_on_older_than(self, seconds: float, *, of: str) -> CheckedRun:
        """When this timer's callback begins, the last message of a subscription is not older."""
        return self.run.has_callbacks(of).passes(checks.data_never_older(of, self.name, seconds))

    def never_loses_messages(self) -> CheckedRun:
        """Its queue never overflows."""
        return self.run.passes(checks.never_loses_messages(self.name))

    def never_overlaps(self, *others: str) -> CheckedRun:
        """It never runs beside others, or beside itself if none is named."""
        return self.run.has_callbacks(*others).passes(checks.never_overlap(self.name, *others))

    def overlaps(self, other: str) -> CheckedRun:
        """It runs at the same time as another one at least once."""
        return self.run.has_callbacks(other).passes(checks.overlap(self.name, other))

    def never_gets_ahead_of(self, other: str) -> CheckedRun:
        """Each of its calls comes after one more call of another callback."""
        return self.run.has_callbacks(other).passes(checks.never_gets_ahead_of(self.name, other))

    def ticks_on_time(self, within: float) -> CheckedRun:
        """No call of this timer is more than ``within`` seconds late."""
        return self.run.passes(checks.ticks_on_time(self.name, within))


@dataclass(frozen=True)
class AskedService:
    """The assertions on one service; each method returns the run."""

    run: CheckedRun
    name: str

    def answers_within(self, seconds: float) -> CheckedRun:
        """Every call gets its answer within ``seconds``; there is at least one."""
        return self.run.passes(checks.replies_within(self.name, seconds))


@dataclass(frozen=True)
class AskedChain:
    """The assertions on a chain of messages; each method returns the run."""

    run: CheckedRun
    names: Sequence[str]

    def never_takes_longer_than(self, seconds: float) -> CheckedRun:
        """Each message of the first topic that leads to one of the last topic does so within ``seconds``."""
        return self.run.passes(checks.chain_never_takes_longer_than(self.names, seconds))

    def never_uses_older_than(self, seconds: float) -> CheckedRun:
        """Each message of the last topic comes of one of the first topic that is at most ``seconds`` old."""
        return self.run.passes(checks.chain_never_uses_older_than(self.names, seconds))
