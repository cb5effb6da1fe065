"""Runs a program under many thread schedules, several at once, and returns the result of each."""

import os
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.context import BaseContext
from threading import Event

import msgspec

from cbtui.engines.forking import forking_context
from cbtui.engines.session import ProcessSession
from cbtui.runs.judged.check_text import verdict_line
from cbtui.runs.judged.checking import ObservedRun, observe
from cbtui.runs.recorded.repeat import why_unrepeatable
from lessons.checks import problems
from lessons.judge import Judge
from sim.engine.setup import RunSetup
from sim.trace.events import NoticeKind, Severity
from sim.trace.model import Window

_PRELOADED = ["cbtui.cli", "sim.engine.process", "sim.robot.driver", "sim.robot.world"]
"""Modules of an engine, imported once in the server that every run is forked from."""
_STUCK = ("self-made-deadlock", "needs-one-more-worker")
"""Ids of the diagnosis rules on callbacks that wait for ever."""


@dataclass(frozen=True)
class ScheduleFailure:
    """A failure of a run. Failures are equal if ``what`` is; ``detail`` may differ."""

    what: str
    detail: str = field(default="", compare=False)


@dataclass(frozen=True)
class ScheduleResult:
    """The result of one schedule: its failures, and the ids of the rules that found a problem.

    Results that compare equal are the same outcome.
    """

    failures: tuple[ScheduleFailure, ...] = ()
    problems: tuple[str, ...] = ()
    notes: tuple[str, ...] = field(default=(), compare=False)
    """Warnings of the engine."""
    repeatable: bool = field(default=True, compare=False)
    """Whether a run with the same seed is expected to be the same."""

    @property
    def well(self) -> bool:
        """Whether nothing failed; problems of the diagnosis alone are no failures."""
        return not self.failures


@dataclass(frozen=True)
class Exploration:
    """A set-up to explore; ``limit`` is in real seconds per run, ``judge`` may be None."""

    setup: RunSetup
    name: str
    judge: Judge | None
    limit: float

    def results(
        self, seeds: Iterable[int], processes: int | None = None
    ) -> Generator[tuple[int, ScheduleResult], None, None]:
        """Run the schedules of some seeds and yield their results in order of completion.

        ``processes`` run at once, by default one per core. Closing the iterator ends all of them.
        """
        given_up = Event()
        context = forking_context(_PRELOADED)
        with ThreadPoolExecutor(processes or _cores()) as pool:
            running = {pool.submit(self._result, seed, context, given_up): seed for seed in seeds}
            try:
                for done in as_completed(running):
                    yield running.pop(done), done.result()
            finally:
                given_up.set()
                pool.shutdown(cancel_futures=True)

    def _result(self, seed: int, context: BaseContext, given_up: Event) -> ScheduleResult:
        setup = msgspec.structs.replace(self.setup, seed=seed)
        observed = observe(setup, self.name, self.limit, given_up, partial(ProcessSession, context=context))
        found = tuple(dict.fromkeys(each.rule.id for each in problems(observed.timeline)))
        failures = tuple(dict.fromkeys(self._failures(observed, found)))
        repeatable = why_unrepeatable(observed.timeline.notices) is None
        return ScheduleResult(failures, found, tuple(dict.fromkeys(_warnings(observed))), repeatable)

    def _failures(self, observed: ObservedRun, found: tuple[str, ...]) -> Iterator[ScheduleFailure]:
        raised = [*_raised(observed)]
        yield from raised
        for rule in found:
            if rule in _STUCK:
                yield ScheduleFailure(f"deadlock: {rule}")
        for notice in observed.timeline.notices:
            if notice.kind is NoticeKind.DEADLOCK:
                yield ScheduleFailure("deadlock", f"{notice.problem}; {notice.advice}")
            elif notice.severity is Severity.ERROR:
                yield ScheduleFailure(notice.text)
        if observed.broken_off:
            yield ScheduleFailure("it did not come to its end", observed.trouble or "")
        elif observed.trouble is not None and not raised:
            yield ScheduleFailure(observed.trouble)
        elif observed.trouble is None and self.judge is not None:
            for each in self.judge.verdicts(observed.timeline):
                if not each.verdict.passed:
                    yield ScheduleFailure(f"check failed: {each.check.asks}", verdict_line(each))


def _warnings(observed: ObservedRun) -> Iterator[str]:
    return (each.text for each in observed.timeline.notices if each.severity is Severity.WARN)


def _raised(observed: ObservedRun) -> Iterator[ScheduleFailure]:
    """The exceptions that came out of callbacks, by callback and kind; with the place if the run ended so."""
    timeline, trouble = observed.timeline, observed.trouble or ""
    whole = Window(0, timeline.end + 1)
    for entity in timeline.entities.values():
        for span in timeline.spans_of(entity.id, whole):
            if span.error:
                text = span.error.removeprefix(f"{span.exception}: ")
                detail = trouble if span.error in trouble else text
                yield ScheduleFailure(f"{entity.spoken_name} raised {span.exception}", detail)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
