"""Runs a program in other orders of its threads, several at once, and returns the result of each."""

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
"""What an engine needs; it is imported once, and every run begins with a copy of that process."""
_STUCK = ("self-made-deadlock", "needs-one-more-worker")
"""The rules of the diagnosis that find callbacks which wait for ever."""


@dataclass(frozen=True)
class ScheduleFailure:
    """What went wrong in a run. Two are the same if they are called the same, whatever the figures."""

    what: str
    detail: str = field(default="", compare=False)


@dataclass(frozen=True)
class ScheduleResult:
    """What came of a schedule: what failed, and the ids of the rules that found a problem, in their order.

    Schedules with equal results came out alike.
    """

    failures: tuple[ScheduleFailure, ...] = ()
    problems: tuple[str, ...] = ()
    notes: tuple[str, ...] = field(default=(), compare=False)
    """What the engine warned of, in its words."""
    repeatable: bool = field(default=True, compare=False)
    """Whether nothing is known that makes another run with the same seed differ."""

    @property
    def well(self) -> bool:
        """Whether nothing failed. What the diagnosis tells of every order is no failure of one."""
        return not self.failures


@dataclass(frozen=True)
class Exploration:
    """What is run, how its name is said, by whose checks it is judged, and its limit in real seconds."""

    setup: RunSetup
    name: str
    judge: Judge | None
    limit: float

    def results(
        self, seeds: Iterable[int], processes: int | None = None
    ) -> Generator[tuple[int, ScheduleResult], None, None]:
        """Run the schedules of some seeds and yield what came of each, in the order in which they end.

        ``processes`` run at once, None: one for each core. Closing the iterator ends all of them.
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
                kind, _, text = span.error.partition(":")
                detail = trouble if span.error in trouble else text.strip()
                yield ScheduleFailure(f"{entity.spoken_name} raised {kind}", detail)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
