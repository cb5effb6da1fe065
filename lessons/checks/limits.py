"""Checks on how often and in which order callbacks are called, how long they take, and what they lose."""

from itertools import groupby, zip_longest
from operator import attrgetter

from lessons.checks.check import Check, Verdict
from lessons.checks.reading import calls_of, entities_named, seconds, spans_of, whole_run
from sim.quantities.nanoseconds import nearest_ns
from sim.quantities.plural import counted
from sim.trace.descriptions import why_waiting
from sim.trace.figures.waiting import waited_by
from sim.trace.model import Wait
from sim.trace.timeline import Timeline


def is_called_between(callback: str, least: int, most: int | None = None) -> Check:
    """A callback is called ``least`` to ``most`` times in the run; None: any number of times."""
    expected = f"at least {counted(least, 'call')}"
    if most is not None:
        many = counted(most, "call")
        expected = (
            f"exactly {many}" if least == most else f"{least} to {many}" if least else f"at most {many}"
        )

    def judge(run: Timeline) -> Verdict:
        calls = calls_of(run, callback)
        at = calls[-1 if most is None else min(most, len(calls) - 1)].start if calls else None
        in_range = least <= len(calls) and (most is None or len(calls) <= most)
        seen = counted(len(calls), "call") if calls else f"no call of {callback}"
        return Verdict(in_range, expected, seen, at)

    return Check(f"{callback} is called", judge)


def is_called_often(callback: str, at_least: int) -> Check:
    """A callback is called ``at_least`` times in the run."""
    return is_called_between(callback, at_least)


def never_waits_longer_than(callback: str, limit: float) -> Check:
    """A callback that is ready is called within ``limit`` seconds; it is called at least once."""
    most = nearest_ns(limit)
    expected = f"a wait of at most {seconds(most)}"

    def judge(run: Timeline) -> Verdict:
        if not calls_of(run, callback) and not any(_waits(run, callback)):
            return Verdict(False, expected, f"no call of {callback}")
        longest = max(_waits(run, callback), key=lambda series: _length(run, series[-1]), default=None)
        if longest is None:
            return Verdict(True, expected, "no wait")
        length = _length(run, longest[-1])
        why = why_waiting(max(longest, key=lambda wait: _end(run, wait) - wait.start), run)
        seen = f"a wait of {seconds(length, limit)}, {why}"
        return Verdict(length <= most, expected, seen, _end(run, longest[-1]) - length)

    return Check(f"{callback} never waits too long", judge)


def never_runs_longer_than(callback: str, limit: float) -> Check:
    """No call of a callback takes more than ``limit`` seconds; it is called at least once."""
    most = nearest_ns(limit)
    expected = f"calls of at most {seconds(most)}"

    def judge(run: Timeline) -> Verdict:
        spans = spans_of(run, callback)
        if not spans:
            return Verdict(False, expected, f"no call of {callback}")
        longest = max(spans, key=lambda span: span.end_at(run.end) - span.start)
        length = longest.end_at(run.end) - longest.start
        return Verdict(length <= most, expected, f"a call of {seconds(length, limit)}", longest.start)

    return Check(f"{callback} never takes too long", judge)


def never_takes_older_than(subscription: str, limit: float) -> Check:
    """A subscription's callback gets messages, and none that is older than ``limit`` seconds."""
    most = nearest_ns(limit)
    expected = f"messages of at most {seconds(most)}"

    def judge(run: Timeline) -> Verdict:
        calls = calls_of(run, subscription)
        if not calls:
            return Verdict(False, expected, f"no call of {subscription}")
        oldest = max(calls, key=lambda span: span.age)
        seen = f"a message {seconds(oldest.age, limit)} old"
        return Verdict(oldest.age <= most, expected, seen, oldest.start)

    return Check(f"{subscription} never takes an old message", judge)


def never_loses_messages(subscription: str) -> Check:
    """The queue of a subscription, named by callback or topic, loses no message."""
    expected = "no message lost"

    def judge(run: Timeline) -> Verdict:
        found = entities_named(run, subscription)
        if not found:
            return Verdict(False, expected, f"there is no {subscription}")
        lost = sorted(at for each in found for at in run.losses_of(each, whole_run(run)))
        seen = f"{counted(len(lost), 'message')} lost" if lost else "none"
        return Verdict(not lost, expected, seen, lost[0] if lost else None)

    return Check(f"{subscription} loses no message", judge)


def begin_in_order(*callbacks: str) -> Check:
    """Each of some callbacks is called, and their first calls begin in this order."""
    expected = ", then ".join(callbacks)

    def judge(run: Timeline) -> Verdict:
        first = {name: [span.start for span in calls_of(run, name)[:1]] for name in callbacks}
        missing = next((name for name in callbacks if not first[name]), None)
        if missing is not None:
            return Verdict(False, expected, f"no call of {missing}")
        seen = sorted(callbacks, key=lambda name: first[name][0])
        wrong = next((there for here, there in zip(callbacks, seen, strict=True) if here != there), None)
        at = None if wrong is None else first[wrong][0]
        return Verdict(wrong is None, expected, ", then ".join(seen), at)

    return Check("callbacks begin in order", judge)


def never_gets_ahead_of(callback: str, other: str) -> Check:
    """At no time has a callback been called more often than another one; it is called at least once."""
    expected = f"at most one call for each of {other}"

    def judge(run: Timeline) -> Verdict:
        calls, others = ([span.start for span in calls_of(run, name)] for name in (callback, other))
        if not calls:
            return Verdict(False, expected, f"no call of {callback}")
        for number, (at, before) in enumerate(zip_longest(calls, others[: len(calls)])):
            if before is None or before > at:
                seen = f"call {number + 1} of {callback} after {counted(number, 'call')} of {other}"
                return Verdict(False, expected, seen, at)
        return Verdict(True, expected, f"{len(calls)} after {len(others)}")

    return Check(f"{callback} never gets ahead of {other}", judge)


def _waits(run: Timeline, name: str) -> list[list[Wait]]:
    """Yield the waits of a callback, topic or service: a series for each call, as the reason may change."""
    return [
        [*series]
        for each in entities_named(run, name)
        for _, series in groupby(run.waits_of(each, whole_run(run)), key=attrgetter("since"))
    ]


def _length(run: Timeline, last: Wait) -> int:
    return waited_by(_end(run, last), last, run)


def _end(run: Timeline, wait: Wait) -> int:
    return run.end if wait.end is None else wait.end
