"""Whether a program did the same on the model and on real rclpy: what each callback did, aligned by order.

On a machine nothing comes exactly when it is due, computing takes time, and publishers and subscriptions
first have to find each other. None of these is a difference: a callback counts from its first call on, times
may differ by some ``JITTER``, and one run may have come one call further than the other.
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

GROUNDS = ("the model", "real rclpy")
"""What the two runs are called in sentences."""
JITTER: Nanoseconds = SECOND // 20
_LONG: Nanoseconds = SECOND // 2
"""How long a callback has to wait, or not to return, for that to be compared."""
_TO_FIND: Nanoseconds = 3 * SECOND
"""How much later a callback's first call may be: discovery has to find its publisher first."""
_PACE = 50
"""One call in so many may be missing: a machine publishes a little more slowly than the rate says."""
_NUMBER = re.compile(r"\d+(\.\d+)?")


@dataclass(frozen=True, slots=True, order=True)
class Difference:
    """Something that happened on one ground alone, or otherwise there: when, and a clause that says what."""

    at: Nanoseconds
    what: str


@dataclass(frozen=True)
class _Calls:
    """What one callback did in one run; ``ground`` is what the run is called."""

    ground: str
    figures: CallbackInRun
    timeline: Timeline
    window: Window
    settled: Nanoseconds
    """When every subscription had heard something."""

    @cached_property
    def spans(self) -> Sequence[Span]:
        """The first spans of its calls."""
        return self.timeline.calls_begun(self.figures.figures.entity.id, self.window)

    @property
    def count(self) -> int:
        """How often it was called."""
        return len(self.spans)

    @property
    def first(self) -> Nanoseconds:
        """When it was called first; the end of the run if it never was."""
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
        """When it raised first, and what; 0 and "" for never."""
        return next(((span.start, span.error) for span in self.spans if span.error), (0, ""))

    @property
    def logged(self) -> list[tuple[Nanoseconds, str]]:
        """What it wrote to the log once all was settled, with numbers left out: measurements differ."""
        entity = self.figures.figures.entity.id
        lines = (line for line in self.timeline.logs if getattr(line, "entity", 0) == entity)
        return [
            (line.t, _NUMBER.sub("#", line.text))
            for line in lines
            if self.settled <= line.t < self.window.end
        ]

    def why_silent(self, gap: Window) -> str:
        """Why it waited most of a gap, in brackets; "" if it did not."""
        waits = self.timeline.waits_of(self.figures.figures.entity.id, gap)
        longest = max(waits, key=lambda wait: _length(wait, self.window.end), default=None)
        return "" if longest is None else f" ({why_waiting(longest, self.timeline)})"


def differences(model: Timeline, real: Timeline, window: Window) -> list[Difference]:
    """Compare a program's runs on the model and on real rclpy; returns what differs, in order of time.

    Of each callback the most telling difference counts: the others follow from it.
    """
    found = [*_of_ends(model, real), *_of_diagnoses(model, real), *_of_orders(model, real, window)]
    settled = [_settled(timeline, window) for timeline in (model, real)]
    for pair in compare(model, real, window).callbacks:
        known = pair.first or pair.second
        if known is not None and not is_models(known.figures.entity):
            found += list(_of_callback(pair, known, (model, real), settled, window))[:1]
    return sorted(found)


def _settled(timeline: Timeline, window: Window) -> Nanoseconds:
    """When every subscription had heard something that it heard soon, or else at all."""
    firsts = (
        calls[0].start
        for each in timeline.entities.values()
        if each.kind is EntityKind.SUBSCRIPTION and (calls := timeline.calls_begun(each.id, window))
    )
    return max((first for first in firsts if first < _TO_FIND), default=0)


def _of_callback(
    pair: CallbackPair,
    known: CallbackInRun,
    runs: tuple[Timeline, Timeline],
    settled: Sequence[Nanoseconds],
    window: Window,
) -> Iterator[Difference]:
    if pair.first is None or pair.second is None:
        ground, other = GROUNDS if pair.second is None else GROUNDS[::-1]
        calls = counted(known.figures.calls, "call")
        yield Difference(0, f"{pair.name} is there on {ground} alone ({calls}), not on {other}")
        return
    one = _Calls(GROUNDS[0], pair.first, runs[0], window, settled[0])
    other_one = _Calls(GROUNDS[1], pair.second, runs[1], window, settled[1])
    for look in _LOOKS:
        yield from look(pair.name, one, other_one)


def _of_first_calls(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    early, late = sorted((one, other), key=lambda calls: calls.first)
    if late.count == 0 < early.count and early.first < early.window.end - JITTER:
        calls = counted(early.count, "call")
        yield Difference(
            early.first, f"on {late.ground} {name} never runs, on {early.ground} it does ({calls})"
        )
    elif late.first - early.first > _TO_FIND:
        text = f"on {late.ground} {name} first runs at {duration(late.first)}"
        yield Difference(early.first, f"{text}, on {early.ground} at {duration(early.first)}")


def _of_returns(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    for hung, fine in ((one, other), (other, one)):
        if hung.unfinished.length - fine.longest > _LONG > fine.unfinished.length:
            at = hung.unfinished.start
            text = f"on {hung.ground} {name} does not return from its call at {duration(at)}"
            yield Difference(at, f"{text}, on {fine.ground} it does")


def _of_errors(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    if one.error[1] != other.error[1]:
        said = (f"on {each.ground} it raises {each.error[1] or 'nothing'}" for each in (one, other))
        yield Difference(max(one.error[0], other.error[0]), f"{name}: {', '.join(said)}")


def _of_gaps(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    """A time in which it was not called on one ground, and was on the other."""
    usual = max(one, other, key=lambda calls: calls.count).usual_gap
    slack = usual + 4 * JITTER + abs(one.settled - other.settled)
    found = [
        Difference(
            gap.start,
            f"on {silent.ground} {name} does not run for {duration(gap.length)} from {duration(gap.start)} on"
            f"{silent.why_silent(gap)}, on {busy.ground} it does",
        )
        for silent, busy in ((one, other), (other, one))
        for gap in silent.gaps
        if min(one.count, other.count) > 1
        and gap.length > usual // 2 + slack
        and gap.length - max(_shared(gap, each) for each in busy.gaps) > slack
    ]
    yield from sorted(found)[:1]


def _of_counts(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    fewer, more = sorted((one, other), key=lambda calls: calls.count)
    if more.count - fewer.count > 1 + _begun_between(fewer, more) + more.count // _PACE:
        times = counted(more.count - fewer.count, "time")
        counts = f"{more.count} against {fewer.count} on {fewer.ground}"
        yield Difference(fewer.window.end, f"on {more.ground} {name} runs {times} more: {counts}")


def _of_lengths(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    lengths = [each.figures.figures.duration for each in (one, other)]
    if lengths[0] is None or lengths[1] is None:
        return
    first, second = lengths[0].median, lengths[1].median
    if abs(first - second) > 2 * JITTER + max(first, second) // 10:
        text = f"{name} takes {duration(first)} on {one.ground} and {duration(second)} on {other.ground}"
        yield Difference(max(one.first, other.first), text)


def _of_reasons(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    waits = [each.figures.waits for each in (one, other)]
    if waits[0] is None or waits[1] is None or min(each.longest for each in waits if each) < _LONG:
        return
    if waits[0].why != waits[1].why:
        said = (
            f"on {each.ground} {waited.why}"
            for each, waited in zip((one, other), waits, strict=True)
            if waited
        )
        yield Difference(max(one.first, other.first), f"{name} waits for other reasons: {', '.join(said)}")


def _of_losses(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    fewer, more = sorted((one, other), key=lambda calls: calls.figures.figures.drops)
    lost, kept = more.figures.figures.drops, fewer.figures.figures.drops
    if lost - kept > 2 + _begun_between(fewer, more) + lost // 20:
        text = f"on {more.ground} {name} loses {counted(lost, 'message')}, on {fewer.ground} {kept}"
        yield Difference(more.timeline.losses_of(more.figures.figures.entity.id, more.window)[0], text)


def _of_logs(name: str, one: _Calls, other: _Calls) -> Iterator[Difference]:
    for (at, first), (_, second) in zip(one.logged, other.logged, strict=False):
        if first != second:
            text = f"{name} logs {first!r} on {one.ground} where it logs {second!r} on {other.ground}"
            yield Difference(at, text)
            return


_LOOKS: tuple[Callable[[str, _Calls, _Calls], Iterator[Difference]], ...] = (
    _of_first_calls,
    _of_returns,
    _of_errors,
    _of_gaps,
    _of_counts,
    _of_lengths,
    _of_reasons,
    _of_losses,
    _of_logs,
)
"""The most telling first."""


def _of_ends(model: Timeline, real: Timeline) -> Iterator[Difference]:
    ends = [timeline.ended for timeline in (model, real)]
    if ends[0] is None or ends[1] is None:
        return
    if (ends[0].failed, ends[0].time_was_up) != (ends[1].failed, ends[1].time_was_up):
        said = (f"on {ground}: {end.reason}" for ground, end in zip(GROUNDS, ends, strict=True) if end)
        yield Difference(min(end.t for end in ends if end), f"the run ends {'; '.join(said)}")


def _of_diagnoses(model: Timeline, real: Timeline) -> Iterator[Difference]:
    """What is wrong on one ground alone."""
    found = [dict(_problems(timeline)) for timeline in (model, real)]
    for ground, ours, theirs in zip(GROUNDS, found, found[::-1], strict=True):
        for key in ours.keys() - theirs.keys():
            at, what = ours[key]
            yield Difference(at, f"the diagnosis finds on {ground} alone: {what}")


def _problems(timeline: Timeline) -> Iterator[tuple[tuple[str, str], tuple[Nanoseconds, str]]]:
    """Rules and the callbacks in which they find a problem, with when and what.

    Those of a deadlock wait for each other, and several may wait for one: who is named first may differ.
    """
    for each in diagnose(timeline):
        entity = timeline.entities.get(each.subject)
        if each.rule.weigh(each, timeline) is Weight.PROBLEM and not (entity and is_models(entity)):
            told = each.rule.explain(each, timeline)
            culprit = timeline.entities.get(each.culprit) if each.rule.by_culprit else None
            named = culprit or entity
            name = "" if named is None or told.for_ever else named.spoken_name
            yield (each.rule.id, name), (each.at, told.what)


def _of_orders(model: Timeline, real: Timeline, window: Window) -> Iterator[Difference]:
    """In which order the only thread of an executor served callbacks that it had kept waiting."""
    for (at, first), (_, second) in zip(_served(model, window), _served(real, window), strict=False):
        if first != second and set(first) == set(second):
            said = (
                f"on {ground} {', '.join(names)}"
                for ground, names in zip(GROUNDS, (first, second), strict=True)
            )
            yield Difference(at, f"what has waited runs in another order: {'; '.join(said)}")
            return


def _served(timeline: Timeline, window: Window) -> Iterator[tuple[Nanoseconds, list[str]]]:
    """What such a thread ran, one after the other, when all had waited for long, and from when on."""
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
    """How many calls usually begin during the delay of its first call on the slower ground."""
    usual = max(one, other, key=lambda calls: calls.count).usual_gap
    return abs(one.first - other.first) / max(JITTER, usual)


def _shared(one: Window, other: Window) -> Nanoseconds:
    return min(one.end, other.end) - max(one.start, other.start)


def _length(wait: Wait, end: Nanoseconds) -> Nanoseconds:
    return (end if wait.end is None else wait.end) - wait.start
