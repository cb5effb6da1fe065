"""The news of a run as sentences, in the order in which they became known."""

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from cbtui.runs.live.findings import ExplainedFinding
from cbtui.screens.parts.copying import what_runs
from cbtui.widgets.diagnosis import response_of
from cbtui.widgets.lanes.names import short_thread
from cbtui.widgets.log.line import line_of
from cbtui.widgets.narrator.decisions import returning
from cbtui.widgets.narrator.narration import narration
from cbtui.widgets.narrator.waits import waiting
from sim.diagnosis import location_text, with_stop
from sim.quantities.durations import duration, timestamp
from sim.quantities.nanoseconds import SECOND
from sim.quantities.plural import counted
from sim.trace.descriptions import name_of
from sim.trace.events import Logged, Severity
from sim.trace.figures.waiting import waited_by
from sim.trace.model import Nanoseconds, Span, Wait, Window
from sim.trace.timeline import Timeline

LEAST: tuple[Nanoseconds, ...] = (0, 10_000_000, 100_000_000, 1_000_000_000)
"""Least lengths of reported calls and waits; the user chooses one."""
USUAL = 2
_LOUD = (Severity.ERROR, Severity.FATAL)
_NUMBER = re.compile(r"\d+(?:\.\d+)?")
_MOST_LINES = 3
"""The most new lines of the log per turn."""


class News(NamedTuple):
    """A sentence, and the moment from which it is true."""

    at: Nanoseconds
    text: str


class Narrative:
    """Reports what is new in a growing run, everything once. Not thread-safe.

    Calls and waits are reported from ``least`` nanoseconds on. Log lines that differ only in numbers are
    reported once, unless the log is ``whole``; errors are always reported.
    """

    def __init__(self, timeline: Timeline, least: Nanoseconds = LEAST[USUAL], *, whole: bool = False) -> None:
        self.least = least
        self.whole = whole
        self._timeline = timeline
        self._told_to: Nanoseconds = 0
        self._lines = 0
        self._known: set[str] = set()
        self._begun: set[tuple[int, Nanoseconds]] = set()
        self._problems: set[tuple[str, int]] = set()

    def news(self, now: Nanoseconds, findings: Sequence[ExplainedFinding]) -> list[str]:
        """Return the news at a moment; everything before is new if that precedes the last reported moment."""
        if now < self._told_to:
            self._told_to = self._lines = 0
            self._known.clear()
            self._begun.clear()
            self._problems.clear()
        window = Window(self._told_to, now + 1)
        found = sorted([*self._calls(window), *self._waits(window), *self._service_calls(window)])
        self._told_to = now
        return [*(each.text for each in found), *self._log(now), *self._problems_among(findings, now)]

    def _calls(self, window: Window) -> Iterator[News]:
        timeline, now = self._timeline, window.end - 1
        for thread in timeline.threads.values():
            for span in timeline.spans_on(thread.id, window):
                if min(now, span.end_at(now)) - span.start >= self.least:
                    where = short_thread(thread.name)
                    runs = f"{timestamp(span.start)}: {name_of(span.entity, timeline)} runs on {where}"
                    ends = f"{timestamp(span.end or 0)}: {returning(span, timeline)}"
                    yield from self._begin_and_end(-1 - thread.id, span, now, runs, ends)

    def _waits(self, window: Window) -> Iterator[News]:
        timeline, now = self._timeline, window.end - 1
        for entity in timeline.entities.values():
            for wait in timeline.waits_of(entity.id, window):
                end = min(now, wait.end_at(now))
                if not wait.is_for_own_call and end - wait.since >= self.least:
                    begins = f"{timestamp(wait.start)}: {waiting(wait, timeline, wait.start, 'waits')}"
                    took = duration(waited_by(end, wait, timeline))
                    ends = f"{timestamp(end)}: {entity.spoken_name} waits no longer, after {took}"
                    yield from self._begin_and_end(entity.id, wait, now, begins, ends)

    def _service_calls(self, window: Window) -> Iterator[News]:
        """Yield the calls from outside, their replies, and which have had none for a second."""
        for call in self._timeline.calls_within(Window(max(0, window.start - SECOND), window.end)):
            late = call.sent + SECOND
            moments = [(call.sent, "is called")]
            if call.replied is None or call.replied > late:
                moments.append((late, "has had no reply for 1.0 s"))
            if call.replied is not None:
                moments.append((call.replied, f"replied {response_of(call)}"))
            for at, what in moments if call.caller == 0 else ():
                if window.start < at < window.end:
                    yield News(at, f"{timestamp(at)}: {call.service} {what}")

    def _begin_and_end(
        self, subject: int, bar: Span | Wait, now: Nanoseconds, begins: str, ends: str
    ) -> Iterator[News]:
        """Yield a bar's sentences that were not reported yet."""
        key = (subject, bar.start)
        if key not in self._begun and (bar.end is None or bar.end > self._told_to):
            self._begun.add(key)
            yield News(bar.start + self.least, begins)
        if bar.end is not None and bar.end <= now and key in self._begun:
            self._begun.remove(key)
            yield News(bar.end, ends)

    def _log(self, now: Nanoseconds) -> Iterator[str]:
        new = self._timeline.logs[self._lines : self._timeline.logs_until(now)]
        self._lines += len(new)
        shown = 0
        for event in new:
            is_loud = isinstance(event, Logged) and event.severity in _LOUD
            text = _NUMBER.sub("", event.text)
            if self.whole or is_loud or text not in self._known:
                self._known.add(text)
                shown += 1
                if self.whole or is_loud or shown <= _MOST_LINES:
                    yield f"log: {line_of(event)}"
        if shown > _MOST_LINES and not self.whole:
            yield f"log: {counted(shown - _MOST_LINES, 'more line')}"

    def _problems_among(self, findings: Sequence[ExplainedFinding], now: Nanoseconds) -> Iterator[str]:
        for each in findings:
            key = each.finding.rule.id, each.finding.subject
            at = self._timeline.end if each.at is None else each.at
            if each.is_problem and at <= now and key not in self._problems:
                self._problems.add(key)
                yield f"problem: {told_finding(each)}"


def told_finding(each: ExplainedFinding) -> str:
    """Return a finding as one line: its kind, what is wrong, why, what to do, and where."""
    explained = each.explanation
    where = location_text(each.finding, explained)
    parts = (each.headline, f"why: {explained.why}", f"what to do: {explained.cure}", where)
    *clauses, last = filter(None, parts)
    return " ".join([*map(with_stop, clauses), last])


def told_moment(timeline: Timeline, at: Nanoseconds) -> Iterator[str]:
    """Yield the executor's last action by a moment, what still waited then and why, and what runs."""
    if timeline.neighbour(at + 1, -1) != at:
        yield f"{timestamp(at)}; the last event before that:"
    yield from narration(timeline, at)
    yield from what_runs(timeline, at)
