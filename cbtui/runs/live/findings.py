"""Findings of the diagnosis rules in a growing run, refreshed at a bounded cost."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import monotonic, thread_time
from typing import NamedTuple

from sim.diagnosis import Diagnoses, Explanation, Finding, Weight
from sim.diagnosis.edits.flags import only_sleeps
from sim.diagnosis.time_limits import ends_by_itself, time_limit
from sim.diagnosis.words import who
from sim.quantities.plural import counted
from sim.trace.events import Doing, Logged
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

_MIN_INTERVAL = 0.5
"""Least seconds between two updates."""
_TIME_SHARE = 0.01
"""The share of time that updates may compute: the longer one does, the later the next."""
_MAX_GROWTH: Nanoseconds = 20_000_000_000
"""Growth after which an update is not delayed: a recording grows by minutes while it is read, and one update
for all of that would block the keys."""
_STANDS_STILL: Nanoseconds = 1_000_000_000
"""A program stands still if nothing but stuck callbacks has run for this time."""


@dataclass(frozen=True, slots=True)
class ExplainedFinding:
    """A finding, how much it matters, and its explanation."""

    finding: Finding
    weight: Weight
    explanation: Explanation
    kind: str
    """The kind of problem, by which lessons say that they show it."""

    @property
    def is_problem(self) -> bool:
        """Whether something goes wrong; else it is only worth knowing."""
        return self.weight is Weight.PROBLEM

    @property
    def name(self) -> str:
        """The rule's name in words: ``group starvation``; "" if the explanation begins with its last word."""
        name = self.finding.rule.id.replace("-", " ")
        return "" if self.explanation.what.startswith(name.rpartition(" ")[2]) else name

    @property
    def headline(self) -> str:
        """What is wrong, behind the rule's name."""
        return f"{self.name}: {self.explanation.what}".removeprefix(": ")

    @property
    def at(self) -> Nanoseconds | None:
        """The moment of the finding; None if it is about the whole run, in which nothing is stuck."""
        return self.finding.at if self.finding.at or self.finding.stuck else None

    @property
    def leads_somewhere(self) -> bool:
        """Whether there is a moment or a line of code to go to."""
        return self.at is not None or self.explanation.place is not None


class Standstill(NamedTuple):
    """All callbacks that still run are stuck; ``moves`` is the one thread that goes on beside them, or "".

    ``only`` is a callback that may go on, and because of which nothing else is served; "" for none.
    """

    since: Nanoseconds
    moves: str = ""
    only: str = ""


class FindingsMonitor:
    """Updates the findings of the rules in a timeline. Not thread-safe, like the timeline.

    ``clock`` tells real time in seconds, ``computed`` for how many this thread has computed: waiting for a
    processor does not put an update off.
    """

    def __init__(
        self,
        timeline: Timeline,
        diagnoses: Diagnoses | None = None,
        clock: Callable[[], float] = monotonic,
        computed: Callable[[], float] = thread_time,
    ) -> None:
        self.findings: tuple[ExplainedFinding, ...] = ()
        """The findings of the last update, the worst problem first."""
        self._timeline = timeline
        self._diagnoses = diagnoses or Diagnoses()
        self._clock = clock
        self._computed = computed
        self._due = self._cost = 0.0
        self.looked_to: Nanoseconds = 0
        """The end of the run at the last update."""
        self._notices = 0

    def stuck_at(self, at: Nanoseconds) -> Finding | None:
        """The finding on callbacks that had stopped for ever by a moment; None if there is none."""
        endless = (each.finding for each in self.findings if each.explanation.for_ever)
        return next((found for found in endless if found.known_at <= at), None)

    def standstill(self) -> Standstill | None:
        """Since when all callbacks that run are stuck, or one starves all; None if others run, or move."""
        timeline = self._timeline
        found = self.stuck_at(timeline.end)
        if found is None:
            return self._starved()
        if timeline.end - found.at < _STANDS_STILL:
            return None
        stuck = {
            entity for each in self.findings if each.explanation.for_ever for entity in each.finding.stuck
        }
        since = Window(timeline.end - _STANDS_STILL, timeline.end + 1)
        ran = (span.entity for thread in timeline.threads for span in timeline.spans_on(thread, since))
        if not stuck.issuperset(ran):
            return None
        moving = self._own_threads_moving(since.start) | self._threads_logging(since.start)
        if len(moving) > 1 or "" in moving:
            return None
        return Standstill(found.at, *moving)

    def _starved(self) -> Standstill | None:
        """Since when others wait for the only callback that runs, in a loop or wait that others may end."""
        timeline = self._timeline
        since = Window(timeline.end - _STANDS_STILL, timeline.end + 1)
        ran = [span for thread in timeline.threads for span in timeline.spans_on(thread, since)]
        at = timeline.position_on(ran[0].thread, timeline.end) if len(ran) == 1 else None
        if at is None or ran[0].start > since.start:
            return None
        polls = at.loop[0] and not ends_by_itself(*at.loop)
        if not polls and (at.doing is not Doing.WAITS or time_limit(at)):
            return None
        waiting = timeline.moment(timeline.end).waiting.items()
        kept = [wait.since for each, wait in waiting if wait.holder == at.entity != each]
        return Standstill(min(kept), only=who(at.entity, timeline)) if kept else None

    def _threads_logging(self, since: Nanoseconds) -> set[str]:
        """The threads that have logged, "" for an unknown one."""
        timeline = self._timeline
        lines = timeline.logs[timeline.logs_until(since) :]
        threads = (timeline.threads.get(each.thread) if isinstance(each, Logged) else None for each in lines)
        return {"" if thread is None else thread.name for thread in threads}

    def _own_threads_moving(self, since: Nanoseconds) -> set[str]:
        """The threads that the program has started and that compute, sleep, went on, or may with a lock.

        Sleeping in a loop that does nothing else is no going on.
        Whoever has a lock and is not known to wait may compute, and release it.
        """
        timeline = self._timeline
        own = timeline.own_threads_at(timeline.end)
        acts = (each for each in own if each.doing in (Doing.SLEEPS, Doing.COMPUTES))
        moving = {each.name for each in acts if not only_sleeps(each.frames[-1][0], each.frames[-1][2])}
        moving |= {each.name for each in {*own} ^ {*timeline.own_threads_at(since)}}
        waiting = {each.name for each in own} | {each.name for each in timeline.threads.values()}
        stands = (timeline.position_on(thread, timeline.end) for thread in timeline.threads)
        wanted = (each for each in stands if each is not None and not each.is_left)
        return moving | {each.taken_by for each in wanted if each.taken_by and each.taken_by not in waiting}

    def update_when_due(self) -> bool:
        """Update if it is time, the run has grown much, or its engine has reported something.

        Returns whether the findings changed.
        """
        grown = self._timeline.end - self.looked_to
        has_news = len(self._timeline.notices) != self._notices
        if self._clock() < self._due and grown < _MAX_GROWTH and not has_news:
            return False
        before = self.findings
        self.update()
        return self.findings != before

    def update(self) -> None:
        """Update the findings now."""
        began, computed = self._clock(), self._computed()
        timeline = self._timeline
        self.looked_to, self._notices = timeline.end, len(timeline.notices)
        self.findings = tuple(_explained(found, timeline) for found in self._diagnoses.update(timeline))
        before, self._cost = self._cost, self._computed() - computed
        usual = min(before, self._cost)  # what is dear once only, as the first look is, does not put it off
        self._due = max(began + _MIN_INTERVAL, self._clock() + usual / _TIME_SHARE)


def _explained(found: Finding, timeline: Timeline) -> ExplainedFinding:
    weight = found.weight_in(timeline)
    explanation, kind = found.explained(timeline), found.rule.kind(found, timeline)
    return ExplainedFinding(found, weight, explanation, kind)


def problem_count_text(findings: Sequence[ExplainedFinding]) -> str:
    """The number of problems: ``2 problems``; "" for none."""
    count = sum(each.is_problem for each in findings)
    return counted(count, "problem") if count else ""
