"""Runs a program under many thread schedules, several at once, and returns the result of each."""

import os
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from operator import attrgetter
from threading import Event
from typing import Protocol, TypeVar

import msgspec

from cbtui.engines.forking import forking_context
from cbtui.engines.session import ProcessSession
from cbtui.runs.judged.check_text import verdict_line
from cbtui.runs.judged.checking import ObservedRun, observe
from cbtui.runs.judged.schedule_text import conflict_text, stall_text, step_text
from cbtui.runs.recorded.repeat import why_unrepeatable
from lessons.checks import problems
from lessons.judge import Judge
from sim.clock.schedule import Seed
from sim.diagnosis import Finding
from sim.diagnosis.text import location_text
from sim.engine.setup import RunSetup
from sim.trace.events import NoticeKind, Severity, ThreadChosen
from sim.trace.model import Window
from sim.trace.timeline import Timeline

PRELOADED = ["cbtui.cli_commands", "sim.engine.preloaded"]
"""Modules of an engine, imported once in the server that every run is forked from."""

Judged = TypeVar("Judged")
SeedT = TypeVar("SeedT", bound=Seed)


def each_schedule(
    setup: RunSetup,
    name: str,
    limit: float,
    seeds: Iterable[SeedT],
    judge: Callable[[ObservedRun], Judged],
    processes: int | None = None,
) -> Generator[tuple[SeedT, Judged], None, None]:
    """Run the schedules of some seeds; yield each seed with what ``judge`` returns, in order of completion.

    ``seeds`` is asked for more after each run, even if it had none left before. ``processes`` run at once, by
    default one per core; ``judge`` is called on other threads. ``limit`` is in real seconds for each run.
    Closing the iterator ends all runs.
    """
    given_up = Event()
    session = partial(ProcessSession, context=forking_context(PRELOADED))
    coming, at_once = iter(seeds), processes or _cores()

    def result(seed: SeedT) -> Judged:
        return judge(observe(msgspec.structs.replace(setup, seed=seed), name, limit, given_up, session))

    with ThreadPoolExecutor(at_once) as pool:
        running: dict[Future[Judged], SeedT] = {}
        try:
            while True:
                running |= {
                    pool.submit(result, seed): seed for seed in islice(coming, at_once - len(running))
                }
                if not running:
                    return
                for done in wait(running, return_when=FIRST_COMPLETED).done:
                    yield running.pop(done), done.result()
        finally:
            given_up.set()
            pool.shutdown(cancel_futures=True)


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
    told: tuple[str, ...] = field(default=(), compare=False)
    """These problems in words, each with its line."""
    notes: tuple[str, ...] = field(default=(), compare=False)
    """Warnings of the engine."""
    repeatable: bool = field(default=True, compare=False)
    """Whether a run with the same seed is expected to be the same."""
    steps: tuple[str, ...] = field(default=(), compare=False)
    """Where a schedule of moves leaves the usual order, and where another one's machine stalls."""
    conflicts: tuple[str, ...] = field(default=(), compare=False)
    """Where data was used twice, and changed or read by another thread in between."""
    unmatched: bool = field(default=False, compare=False)
    """Whether the run was asked to change a callback that the program does not have."""

    @property
    def well(self) -> bool:
        """Whether nothing failed; problems of the diagnosis alone are no failures."""
        return not self.failures


class Search(Protocol):
    """Returns seeds that depend on the runs of the seeds before."""

    def __iter__(self) -> Iterator[str]:
        """Iterate over the seeds; there may be a next one again after StopIteration."""

    def take(
        self, seed: str, failures: Sequence[ScheduleFailure], choices: Sequence[ThreadChosen], /
    ) -> None:
        """Receive the failures and choices of a run."""


@dataclass(frozen=True)
class Exploration:
    """A set-up to explore; ``limit`` is in real seconds per run, ``judge`` may be None."""

    setup: RunSetup
    name: str
    judge: Judge | None
    limit: float

    def search(
        self, search: Search, processes: int | None = None
    ) -> Generator[tuple[str, ScheduleResult], None, None]:
        """Run the schedules of a search and yield their results as ``each_schedule`` does."""
        found = each_schedule(self.setup, self.name, self.limit, search, self._with_choices, processes)
        with closing(found):
            for seed, (result, choices) in found:
                search.take(seed, result.failures, choices)
                yield seed, result

    def _with_choices(self, observed: ObservedRun) -> tuple[ScheduleResult, Sequence[ThreadChosen]]:
        return self._result(observed), observed.timeline.choices

    def results(
        self, seeds: Iterable[SeedT], processes: int | None = None
    ) -> Generator[tuple[SeedT, ScheduleResult], None, None]:
        """Run the schedules of some seeds and yield their results as ``each_schedule`` does."""
        return each_schedule(self.setup, self.name, self.limit, seeds, self._result, processes)

    def _result(self, observed: ObservedRun) -> ScheduleResult:
        found: dict[str, Finding] = {}
        for problem in problems(observed.timeline):
            found.setdefault(problem.rule.id, problem)
        failures = tuple(dict.fromkeys(self._failures(observed, found)))
        repeatable = why_unrepeatable(observed.timeline.notices) is None
        return ScheduleResult(
            failures,
            tuple(found),
            tuple(_told(each, observed.timeline) for each in found.values()),
            tuple(dict.fromkeys(_warnings(observed))),
            repeatable,
            (
                *map(step_text, filter(attrgetter("chosen"), observed.timeline.choices)),
                *map(stall_text, observed.timeline.stalls),
            ),
            tuple(conflict_text(each, observed.timeline) for each in observed.timeline.conflicts),
            any(each.kind is NoticeKind.UNMATCHED for each in observed.timeline.notices),
        )

    def _failures(self, observed: ObservedRun, found: Mapping[str, Finding]) -> Iterator[ScheduleFailure]:
        raised = [*_raised(observed)]
        yield from raised
        for problem in found.values():
            if (hangs_from := problem.rule.hangs_from) is not None and problem.lasted >= hangs_from:
                yield ScheduleFailure(problem.rule.summary)
        kinds = {each.kind for each in observed.timeline.notices}
        for notice in observed.timeline.notices:
            if notice.kind is NoticeKind.DEADLOCK:
                yield ScheduleFailure("deadlock", f"{notice.problem}; {notice.advice}")
            elif notice.kind is NoticeKind.ENDLESS_WAIT and NoticeKind.DEADLOCK not in kinds:
                yield ScheduleFailure("a callback waits without end", f"{notice.problem}; {notice.advice}")
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


def _told(found: Finding, timeline: Timeline) -> str:
    explanation = found.explained(timeline)
    where = location_text(found, explanation)
    return f"{explanation.what} ({where})" if where else explanation.what


def _warnings(observed: ObservedRun) -> Iterator[str]:
    return (each.text for each in observed.timeline.notices if each.severity is Severity.WARN)


def _raised(observed: ObservedRun) -> Iterator[ScheduleFailure]:
    """The exceptions of callbacks, by callback and class; with its place if one ended the run."""
    timeline, trouble = observed.timeline, observed.trouble
    ended_by = None if timeline.ended is None else timeline.ended.error
    whole = Window(0, timeline.end + 1)
    for entity in timeline.entities.values():
        for span in timeline.spans_of(entity.id, whole):
            if span.error:
                text = span.error.removeprefix(f"{span.exception}: ")
                detail = trouble if trouble and span.error == ended_by else text
                yield ScheduleFailure(f"{entity.spoken_name} raised {span.exception}", detail)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
