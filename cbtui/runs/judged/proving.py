"""Compares a program's runs on the model and on real rclpy: the calls of each callback, in order.

On a machine nothing happens exactly when it is due, computing takes time, and publishers and subscriptions
first have to discover each other. None of this is a difference: a callback counts from its first call on,
times may differ by some ``JITTER``, and one run may be one call ahead of the other.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby, pairwise
from statistics import median

from sim.diagnosis import Weight, diagnose
from sim.diagnosis.rule import is_models
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.quantities.plural import counted
from sim.trace.descriptions import why_waiting
from sim.trace.events import EntityKind
from sim.trace.figures.comparison import CallbackInRun, CallbackPair, compare
from sim.trace.model import Nanoseconds, Span, Wait, Window
from sim.trace.timeline import Timeline

RUN_NAMES = ("the model", "real rclpy")
"""The names of the two runs in sentences."""
JITTER: Nanoseconds = SECOND // 20
_LONG: Nanoseconds = SECOND // 2
"""Waits and calls are compared from this length on."""
_DISCOVERY: Nanoseconds = 3 * SECOND
"""Allowed delay of a callback's first call: discovery has to find its publisher first."""
_CALLS_PER_MISSING = 50
"""One call in this number may be missing: a machine publishes a little more slowly than the rate says."""
_NUMBER = re.compile(r"\d+(\.\d+)?")


@dataclass(frozen=True, slots=True, order=True)
class Difference:
    """Something that happened in one run only, or differently: ``what`` is a clause."""

    at: Nanoseconds
    what: str


@dataclass(frozen=True)
class _Calls:
    """The calls of one callback in one run; ``run`` is the run's name."""

    run: str
    figures: CallbackInRun
    timeline: Timeline
    window: Window
    settled: Nanoseconds
    """When every subscription had received a message."""

    @cached_property
    def spans(self) -> Sequence[Span]:
        """The first spans of its calls."""
        return self.timeline.calls_begun(self.figures.figures.entity.id, self.window)

    @property
    def count(self) -> int:
        """The number of its calls."""
        return len(self.spans)

    @property
    def first(self) -> Nanoseconds:
        """The time of its first call; the end of the run if there was none."""
        return self.spans[0].start if self.spans else self.window.end

    @cached_property
    def gaps(self) -> Sequence[Window]:
        """The time from each of its calls to the next, and from the last one to the end."""
        starts = [*(span.start for span in self.spans), self.window.end]
        return [Window(*pair) for pair in pairwise(starts)]

    @property
    def usual_gap(self) -> Nanoseconds:
        """The median time from a call to the next."""
        return round(median(gap.length for gap in self.gaps[:-1])) if self.count > 1 else 0

    @property
    def unfinished(self) -> Window:
        """The time from the start of its last call to the end of the run; empty if that has returned."""
        is_over = not self.spans or self.spans[-1].end is not None
        return Window(self.window.end if is_over else self.spans[-1].start, self.window.end)

    @property
    def longest(self) -> Nanoseconds:
        """The duration of its longest finished call."""
        lengths = self.figures.figures.duration
        return 0 if lengths is None else lengths.most

    @property
    def error(self) -> tuple[Nanoseconds, str]:
        """The time and text of its first exception; 0 and "" if there was none."""
        return next(((span.start, span.error) for span in self.spans if span.error), (0, ""))

    @property
    def logged(self) -> list[tuple[Nanoseconds, str]]:
        """Its log lines since ``settled``, without their numbers: measurements differ."""
        entity = self.figures.figures.entity.id
        lines = (line for line in self.timeline.logs if getattr(line, "entity", 0) == entity)
        return [
            (line.t, _NUMBER.sub("#", line.text))
            for line in lines
            if self.settled <= line.t < self.window.end
        ]

    def why_silent(self, gap: Window) -> str:
        """The reason of its longest wait in a gap, in brackets; "" if it did not wait."""
        waits = self.timeline.waits_of(self.figures.figures.entity.id, gap)
        longest = max(waits, key=lambda wait: _length(wait, self.window.end), default=None)
        return "" if longest is None else f" ({why_waiting(longest, self.timeline)})"


def differences(model: Timeline, real: Timeline, window: Window) -> list[Difference]:
    """Compare a program's runs on the model and on real rclpy; returns what differs, in order of time.

    Only the most important difference of each callback counts: the others follow from it.
    """
    found = [
        *_ends_differ(model, real),
        *_diagnoses_differ(model, real),
        *_orders_differ(model, real, window),
    ]
    settled = [_settled(timeline, window) for timeline in (model, real)]
    for pair in compare(model, real, window).callbacks:
        known = pair.first or pair.second
        if known is not None and not is_models(known.figures.entity):
            found += list(_callback_differs(pair, known, (model, real), settled, window))[:1]
    return sorted(found)


def _settled(timeline: Timeline, window: Window) -> Nanoseconds:
    """When every subscription that received something within ``_DISCOVERY`` had received it."""
    firsts = (
        calls[0].start
        for each in timeline.entities.values()
        if each.kind is EntityKind.SUBSCRIPTION and (calls := timeline.calls_begun(each.id, window))
    )
    return max((first for first in firsts if first < _DISCOVERY), default=0)


def _callback_differs(
    pair: CallbackPair,
    known: CallbackInRun,
    runs: tuple[Timeline, Timeline],
    settled: Sequence[Nanoseconds],
    window: Window,
) -> Iterator[Difference]:
    if pair.first is None or pair.second is None:
        run, other = RUN_NAMES if pair.second is None else RUN_NAMES[::-1]
        calls = counted(known.figures.calls, "call")
        yield Difference(0, f"{pair.name} is there on {run} alone ({calls}), not on {other}")
        return
    one = _Calls(RUN_NAMES[0], pair.first, runs[0], window, settled[0])
    other_one = _Calls(RUN_NAMES[1], pair.second, runs[1], window, settled[1])
    for compared in _COMPARISONS:
        yield from compared(pair.name, one, other_one)


def _first_calls_differ(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    early, late = sorted((one, other), key=lambda calls: calls.first)
    if late.count == 0 < early.count and early.first < early.window.end - JITTER:
        calls = counted(early.count, "call")
        yield Difference(early.first, f"on {late.run} {name} never runs, on {early.run} it does ({calls})")
    elif late.first - early.first > _DISCOVERY:
        text = f"on {late.run} {name} first runs at {duration(late.first)}"
        yield Difference(early.first, f"{text}, on {early.run} at {duration(early.first)}")


def _returns_differ(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    for hung, fine in ((one, other), (other, one)):
        if hung.unfinished.length - fine.longest > _LONG > fine.unfinished.length:
            at = hung.unfinished.start
            text = f"on {hung.run} {name} does not return from its call at {duration(at)}"
            yield Difference(at, f"{text}, on {fine.run} it does")


def _errors_differ(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    if one.error[1] != other.error[1]:
        said = (f"on {each.run} it raises {each.error[1] or 'nothing'}" for each in (one, other))
        yield Difference(max(one.error[0], other.error[0]), f"{name}: {', '.join(said)}")


def _gaps_differ(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    """Yield the first time in which the callback was silent in one run only."""
    usual = max(one, other, key=lambda calls: calls.count).usual_gap
    slack = usual + 4 * JITTER + abs(one.settled - other.settled)
    found = [
        Difference(
            gap.start,
            f"on {silent.run} {name} does not run for {duration(gap.length)} from {duration(gap.start)} on"
            f"{silent.why_silent(gap)}, on {busy.run} it does",
        )
        for silent, busy in ((one, other), (other, one))
        for gap in silent.gaps
        if min(one.count, other.count) > 1
        and gap.length > usual // 2 + slack
        and gap.length - max(_shared(gap, each) for each in busy.gaps) > slack
    ]
    yield from sorted(found)[:1]


def _counts_differ(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    fewer, more = sorted((one, other), key=lambda calls: calls.count)
    if more.count - fewer.count > 1 + _begun_between(fewer, more) + more.count // _CALLS_PER_MISSING:
        times = counted(more.count - fewer.count, "time")
        counts = f"{more.count} against {fewer.count} on {fewer.run}"
        yield Difference(fewer.window.end, f"on {more.run} {name} runs {times} more: {counts}")


def _durations_differ(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    lengths = [each.figures.figures.duration for each in (one, other)]
    if lengths[0] is None or lengths[1] is None:
        return
    first, second = lengths[0].median, lengths[1].median
    if abs(first - second) > 2 * JITTER + max(first, second) // 10:
        text = f"{name} takes {duration(first)} on {one.run} and {duration(second)} on {other.run}"
        yield Difference(max(one.first, other.first), text)


def _reasons_differ(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    waits = [each.figures.waits for each in (one, other)]
    if waits[0] is None or waits[1] is None or min(each.longest for each in waits if each) < _LONG:
        return
    if waits[0].why != waits[1].why:
        said = (
            f"on {each.run} {waited.why}" for each, waited in zip((one, other), waits, strict=True) if waited
        )
        yield Difference(max(one.first, other.first), f"{name} waits for other reasons: {', '.join(said)}")


def _losses_differ(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    fewer, more = sorted((one, other), key=lambda calls: calls.figures.figures.drops or 0)
    lost, kept = more.figures.figures.drops, fewer.figures.figures.drops
    if lost is None or kept is None:
        return
    if lost - kept > 2 + _begun_between(fewer, more) + lost // 20:
        text = f"on {more.run} {name} loses {counted(lost, 'message')}, on {fewer.run} {kept}"
        yield Difference(more.timeline.losses_of(more.figures.figures.entity.id, more.window)[0], text)


def _logs_differ(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    for (at, first), (_, second) in zip(one.logged, other.logged, strict=False):
        if first != second:
            text = f"{name} logs {first!r} on {one.run} where it logs {second!r} on {other.run}"
            yield Difference(at, text)
            return


_COMPARISONS: tuple[Callable[[str, _Calls, _Calls], Iterator[Difference]], ...] = (
    _first_calls_differ,
    _returns_differ,
    _errors_differ,
    _gaps_differ,
    _counts_differ,
    _durations_differ,
    _reasons_differ,
    _losses_differ,
    _logs_differ,
)
"""The most important comparison first."""


def _ends_differ(model: Timeline, real: Timeline) -> Iterator[Difference]:
    ends = [timeline.ended for timeline in (model, real)]
    if ends[0] is None or ends[1] is None:
        return
    if (ends[0].failed, ends[0].time_was_up) != (ends[1].failed, ends[1].time_was_up):
        said = (f"on {run}: {end.reason}" for run, end in zip(RUN_NAMES, ends, strict=True) if end)
        yield Difference(min(end.t for end in ends if end), f"the run ends {'; '.join(said)}")


def _diagnoses_differ(model: Timeline, real: Timeline) -> Iterator[Difference]:
    found = [dict(_problems(timeline)) for timeline in (model, real)]
    for run, ours, theirs in zip(RUN_NAMES, found, found[::-1], strict=True):
        for key in ours.keys() - theirs.keys():
            at, what = ours[key]
            yield Difference(at, f"the diagnosis finds on {run} alone: {what}")


def _problems(timeline: Timeline) -> Iterator[tuple[tuple[str, str], tuple[Nanoseconds, str]]]:
    """Yield each rule and callback with a problem, and the problem's time and text.

    Callbacks in a deadlock are not named: which one is found first may differ.
    """
    for each in diagnose(timeline):
        entity = timeline.entities.get(each.subject)
        if each.weight_in(timeline) is Weight.PROBLEM and not (entity and is_models(entity)):
            explanation = each.explained(timeline)
            culprit = timeline.entities.get(each.culprit) if each.rule.by_culprit else None
            named = culprit or entity
            name = "" if named is None or explanation.for_ever else named.spoken_name
            yield (each.rule.id, name), (each.at, explanation.what)


def _orders_differ(model: Timeline, real: Timeline, window: Window) -> Iterator[Difference]:
    """Yield the first time at which a single-threaded executor ran waiting callbacks in another order."""
    for (at, first), (_, second) in zip(_served(model, window), _served(real, window), strict=False):
        if first != second and set(first) == set(second):
            said = (
                f"on {run} {', '.join(names)}" for run, names in zip(RUN_NAMES, (first, second), strict=True)
            )
            yield Difference(at, f"what has waited runs in another order: {'; '.join(said)}")
            return


def _served(timeline: Timeline, window: Window) -> Iterator[tuple[Nanoseconds, list[str]]]:
    """Yield the callbacks that such a thread ran in succession after long waits, and when it began."""
    waited = [
        (span.thread, span, timeline.entities[entity].spoken_name)
        for entity in timeline.entities
        for wait in timeline.waits_of(entity, window)
        if wait.end is not None and wait.end - wait.since >= _LONG
        for span in timeline.calls_begun(entity, Window(wait.end, wait.end + JITTER))[:1]
        if not timeline.threads[span.thread].executor
    ]
    waited.sort(key=lambda each: (each[0], each[1].start))
    for _, of_thread in groupby(waited, key=lambda each: each[0]):
        names: list[str] = []
        began = ends = -SECOND
        for _, span, name in of_thread:
            if span.start - ends > JITTER:
                if len(names) > 1:
                    yield began, names
                names, began = [], span.start
            names += [] if name in names else [name]
            ends = span.end_at(window.end)
        if len(names) > 1:
            yield began, names


def _begun_between(one: _Calls, other: _Calls) -> float:
    """The usual number of calls in the time between the first calls of both runs."""
    usual = max(one, other, key=lambda calls: calls.count).usual_gap
    return abs(one.first - other.first) / max(JITTER, usual)


def _shared(one: Window, other: Window) -> Nanoseconds:
    return min(one.end, other.end) - max(one.start, other.start)


def _length(wait: Wait, end: Nanoseconds) -> Nanoseconds:
    return (end if wait.end is None else wait.end) - wait.start
