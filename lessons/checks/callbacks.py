"""Checks on the times at which callbacks run, on overlaps, and on the number of threads."""

from collections.abc import Iterable, Iterator
from heapq import merge

from lessons.checks.check import Check, Verdict
from lessons.checks.reading import Stretch, calls_of, entities_named, seconds, spans_of, whole_run
from sim.quantities.nanoseconds import SECOND, nearest_ns
from sim.quantities.plural import counted
from sim.trace.events import GroupKind
from sim.trace.figures.concurrency import Concurrency
from sim.trace.model import Nanoseconds, Span, Window
from sim.trace.timeline import Timeline

_TOGETHER: Nanoseconds = 1_000_000
"""Least time for which two callbacks overlap: a reader has to find it on the lanes."""


def keeps_coming(callback: str, while_: Stretch, at_least: float) -> Check:
    """A callback (or topic, or service) runs on all through a stretch: ``at_least`` calls a second.

    The worst of several stretches counts; those too short for two calls do not.
    """
    expected = f"at least {at_least:g} calls a second"

    def judge(run: Timeline) -> Verdict:
        if not entities_named(run, callback):
            return _missing(callback, expected)
        long_enough = [each for each in while_.windows(run) if each.length * at_least >= 2 * SECOND]
        if not long_enough:
            return Verdict(False, expected, f"no long stretch in which {while_.words}")
        rates = [(len(calls_of(run, callback, window)), window) for window in long_enough]
        count, window = min(rates, key=lambda pair: pair[0] / pair[1].length)
        passed = count * SECOND >= at_least * window.length
        seen = f"{counted(count, 'call')} in {seconds(window.length)}"
        if count:
            seen = f"{count * SECOND / window.length:.2g} a second, {seen}"
        return Verdict(passed, expected, seen, window.start)

    return Check(f"{callback} keeps coming while {while_.words}", judge)


def overlap(one: str, other: str) -> Check:
    """Two callbacks (or topics, or services) run at the same time at least once.

    The same one twice asks for two calls of it at the same time.
    """
    expected = "two calls at once, at least once"

    def judge(run: Timeline) -> Verdict:
        for name in (one, other):
            if not calls_of(run, name):
                return _missing(name, expected)
        shared = list(_shared(run, one, other))
        if not shared:
            return Verdict(False, expected, "always one after the other", calls_of(run, one)[0].start)
        longest = max(shared, key=lambda window: window.length)
        return Verdict(True, expected, f"both for {seconds(longest.length)}", longest.start)

    asks = f"{one} runs twice at once" if one == other else f"{one} and {other} run at the same time"
    return Check(asks, judge)


def never_overlap(*callbacks: str) -> Check:
    """No two calls of some callbacks, or of a single one, run at the same time; each of them runs."""
    expected = "one call at a time"
    asks = f"{callbacks[0]} never runs twice at once"
    if len(callbacks) > 1:
        asks = f"{', '.join(callbacks[:-1])} and {callbacks[-1]} never run at the same time"

    def judge(run: Timeline) -> Verdict:
        for name in callbacks:
            if not calls_of(run, name):
                return _missing(name, expected)
        found = _first_overlap(run, [spans_of(run, name) for name in callbacks])
        return _alone(run, found, expected)

    return Check(asks, judge)


def exclusive_groups_hold() -> Check:
    """No two callbacks of one mutually exclusive group run at the same time."""
    expected = "one call at a time in each exclusive group"

    def judge(run: Timeline) -> Verdict:
        exclusive = [group.id for group in run.groups.values() if group.kind is GroupKind.EXCLUSIVE]
        found = [_first_overlap(run, [run.spans_in(group, whole_run(run))]) for group in exclusive]
        first = min(filter(None, found), key=lambda pair: pair[1].start, default=None)
        return _alone(run, first, expected)

    return Check("no two callbacks of one exclusive group overlap", judge)


def ticks_on_time(timer: str, within: float) -> Check:
    """No call of a timer's callback begins more than ``within`` seconds after it was due."""
    most = nearest_ns(within)
    expected = f"never more than {seconds(most)} late"

    def judge(run: Timeline) -> Verdict:
        calls = calls_of(run, timer)
        if not calls:
            return _missing(timer, expected)
        latest = max(calls, key=lambda span: span.age)
        passed = latest.age <= most
        if not latest.age:
            return Verdict(True, expected, f"{counted(len(calls), 'call')}, none late")
        return Verdict(passed, expected, f"{seconds(latest.age, within)} late", latest.start)

    return Check(f"{timer} is called on time", judge)


def never_raises() -> Check:
    """No callback ends with an exception."""
    expected = "no exception"

    def judge(run: Timeline) -> Verdict:
        for each in run.entities.values():
            for span in run.spans_of(each.id, whole_run(run)):
                if span.error:
                    return Verdict(False, expected, f"{each.spoken_name}: {span.error}", span.start)
        return Verdict(True, expected, "none")

    return Check("no callback raises", judge)


def raises(*callbacks: str) -> Check:
    """One of some callbacks ends with an exception."""
    expected = "an exception"

    def judge(run: Timeline) -> Verdict:
        seen = [
            f"{each} raised {span.error}" for each in callbacks for span in spans_of(run, each) if span.error
        ]
        return Verdict(bool(seen), expected, seen[0] if seen else "none")

    return Check(f"{' or '.join(callbacks)} raises", judge)


def uses_threads(at_least: int) -> Check:
    """At some moment callbacks run on ``at_least`` threads."""
    expected = f"callbacks on at least {counted(at_least, 'thread')} at once"

    def judge(run: Timeline) -> Verdict:
        most = Concurrency(run).peak(run.end)
        return Verdict(most >= at_least, expected, f"at most {most}")

    return Check(f"{at_least} threads are used at once", judge)


def _missing(name: str, expected: str) -> Verdict:
    return Verdict(False, expected, f"no call of {name}")


def _alone(run: Timeline, found: tuple[Span, Span] | None, expected: str) -> Verdict:
    if found is None:
        return Verdict(True, expected, "no two at once")
    names = [run.entities[span.entity].spoken_name for span in found]
    seen = f"{names[0]} twice at once" if names[0] == names[1] else f"{names[0]} beside {names[1]}"
    return Verdict(False, expected, seen, found[1].start)


def _first_overlap(run: Timeline, lanes: Iterable[Iterable[Span]]) -> tuple[Span, Span] | None:
    """Return the first two spans that overlap, in order of start."""
    latest: Span | None = None
    for span in merge(*lanes, key=lambda span: span.start):
        if latest is not None and span.start < latest.end_at(run.end):
            return latest, span
        if latest is None or span.end_at(run.end) > latest.end_at(run.end):
            latest = span
    return None


def _shared(run: Timeline, one: str, other: str) -> Iterator[Window]:
    """Yield the times for which calls of two callbacks overlap long enough."""
    begun = [(span, name) for name in {one, other} for span in spans_of(run, name)]
    running: list[tuple[Span, str]] = []
    for span, name in sorted(begun, key=lambda pair: pair[0].start):
        running = [pair for pair in running if pair[0].end_at(run.end) > span.start]
        for before, its_name in running:
            end = min(before.end_at(run.end), span.end_at(run.end))
            if (one == other or name != its_name) and end - span.start >= _TOGETHER:
                yield Window(span.start, end)
        running.append((span, name))
