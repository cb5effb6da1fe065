"""Statistics of callbacks: hand-made runs with known figures, random ones against a naive computation."""

from collections.abc import Iterable
from itertools import pairwise
from math import ceil

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.trace.events import (
    AnyEvent,
    CallbackResumed,
    CallbackStarted,
    EntityId,
    EntityKind,
    Reason,
)
from sim.trace.figures.concurrency import threads_at_once
from sim.trace.figures.statistics import (
    CallbackStatistics,
    Distribution,
    ages_used,
    distribution,
    percentile,
    statistics,
    statistics_incrementally,
)
from sim.trace.incremental import run_to_end
from sim.trace.model import Span, Wait, Window
from sim.trace.timeline import Timeline
from tests.support.runs import Run, ns
from tests.trace.naive import Naive
from tests.trace.systems import GROUP_OF, KINDS, THREADS, legal_runs


def timeline_of(events: Iterable[AnyEvent]) -> Timeline:
    timeline = Timeline()
    timeline.extend(events)
    return timeline


def of(run: Run, entity: EntityId, window: Window | None = None) -> CallbackStatistics:
    timeline = timeline_of(run.events)
    return run_to_end(statistics_incrementally(timeline, entity, window or Window(0, timeline.end + 1)))


class Cast:
    """One thread and one group, for runs that need no more."""

    def __init__(self) -> None:
        self.run = Run()
        self.main = self.run.thread("MainThread")
        self.node = self.run.node("/n")
        self.group = self.run.exclusive(self.node)


def test_calls_and_durations_are_of_the_calls_that_begin_and_end_in_the_window() -> None:
    cast = Cast()
    timer = cast.run.timer(cast.group, "tick", 1.0)
    for at, took in ((1.0, 0.1), (2.0, 0.2), (3.0, 0.3), (4.0, None)):
        cast.run.callback(timer, cast.main, at, took)
    assert of(cast.run, timer).calls == 4
    assert of(cast.run, timer).duration == Distribution(3, ns(0.1), ns(0.2), ns(0.3), ns(0.3))
    late = of(cast.run, timer, Window(ns(1.05), ns(3.1)))
    assert (late.calls, late.duration) == (2, Distribution(1, *[ns(0.2)] * 4)), "one had not ended"


def test_a_suspended_call_is_one_call_with_several_stretches() -> None:
    cast = Cast()
    timer = cast.run.timer(cast.group, "later", 1.0)
    cast.run.start(timer, cast.main, 1.0)
    cast.run.suspend(timer, cast.main, 1.1)
    cast.run.resume(timer, cast.main, 2.0)
    cast.run.end(timer, cast.main, 2.3)
    figures = of(cast.run, timer)
    assert figures.calls == 1
    assert figures.duration == Distribution(2, ns(0.1), ns(0.1), ns(0.3), ns(0.3))


def test_a_call_waited_since_its_callback_became_ready_for_whatever_reasons() -> None:
    cast = Cast()
    timer = cast.run.timer(cast.group, "tick", 1.0)
    cast.run.callback(timer, cast.main, 1.0, 0.1)
    cast.run.wait(timer, 2.0, holder=timer)
    cast.run.wait_changes(timer, 2.2, since=2.0, reason=Reason.NO_FREE_WORKER)
    cast.run.wait(timer, 2.0, 2.5)
    cast.run.callback(timer, cast.main, 2.5, 0.1)
    cast.run.callback(timer, cast.main, 3.0, 0.1)
    assert of(cast.run, timer).wait == Distribution(3, 0, 0, ns(0.5), ns(0.5))


def test_a_timers_jitter_is_how_far_its_steps_are_off_the_period() -> None:
    cast = Cast()
    timer = cast.run.timer(cast.group, "tick", 1.0)
    for at in (1.0, 2.0, 3.1, 4.0):
        cast.run.callback(timer, cast.main, at, 0.0, late=at % 1)
    figures = of(cast.run, timer)
    assert figures.jitter == Distribution(3, 0, ns(0.1), ns(0.1), ns(0.1))
    assert figures.late is not None
    assert (figures.late.most, figures.age) == (ns(3.1 % 1), None)


def test_what_waits_as_the_window_ends_counts_as_late_or_old_as_it_is_by_then() -> None:
    cast = Cast()
    timer = cast.run.timer(cast.group, "tick", 1.0)
    odom = cast.run.subscription(cast.group, "/odom", "odom_callback")
    cast.run.message(odom, 0.5)
    cast.run.callback(odom, cast.main, 0.5, 0.0)
    cast.run.callback(timer, cast.main, 1.0, 1.0)
    cast.run.message(odom, 1.5)
    cast.run.wait(odom, 1.5, holder=timer)
    cast.run.start(timer, cast.main, 2.0)
    cast.run.wait(timer, 3.0, holder=timer)
    cast.run.message(odom, 6.0)
    assert of(cast.run, timer).late == Distribution(3, 0, 0, ns(3), ns(3))
    assert of(cast.run, odom).age == Distribution(2, 0, 0, ns(4.5), ns(4.5))
    assert of(cast.run, timer, Window(0, ns(3))).late == Distribution(2, 0, 0, 0, 0)
    assert of(cast.run, odom, Window(ns(1), ns(3))).age == Distribution(1, *[ns(1.5)] * 4)


def test_a_subscriptions_jitter_is_of_its_messages_and_not_of_its_calls() -> None:
    cast = Cast()
    odom = cast.run.subscription(cast.group, "/odom", "odom_callback")
    for at in (1.0, 2.0, 3.0, 4.5):
        cast.run.message(odom, at)
    for at in (1.0, 2.7, 3.0, 4.5):
        cast.run.callback(odom, cast.main, at, 0.0)
    assert of(cast.run, odom).jitter == Distribution(3, 0, 0, ns(0.5), ns(0.5))
    assert of(cast.run, odom).age == Distribution(4, 0, 0, ns(0.7), ns(0.7))


def test_a_timer_uses_the_newest_message_that_each_subscription_of_its_node_has_taken() -> None:
    cast = Cast()
    timer = cast.run.timer(cast.group, "tick", 1.0)
    odom = cast.run.subscription(cast.group, "/odom", "odom_callback")
    scan = cast.run.subscription(cast.group, "/scan", "scan_callback")
    other = cast.run.subscription(cast.run.exclusive(cast.run.node("/other")), "/odom", "elsewhere")
    for entity in (odom, other):
        cast.run.message(entity, 1.5, delay=0.1)
        cast.run.callback(entity, cast.main, 1.5, 0.0)
    for at in (1.0, 2.0, 3.0):
        cast.run.callback(timer, cast.main, at, 0.0)
    cast.run.message(scan, 3.5)
    timeline = timeline_of(cast.run.events)
    assert ages_used(timeline, timeline.entities[timer], Window(0, timeline.end + 1)) == {
        odom: Distribution(2, ns(0.6), ns(0.6), ns(1.6), ns(1.6))
    }


def test_threads_at_once_counts_moments_also_those_of_calls_without_length_and_not_touching_calls() -> None:
    run = Run()
    threads = [run.thread(f"worker {number}") for number in range(3)]
    timer = run.timer(run.reentrant(run.node("/n")), "tick", 1.0)
    for thread, at, took in ((0, 1.0, 1.0), (1, 2.0, 1.0), (2, 2.5, 1.0), (0, 2.7, 0.0)):
        run.callback(timer, threads[thread], at, took)
    timeline = timeline_of(run.events)
    assert threads_at_once(timeline, Window(0, ns(5))) == 3
    assert threads_at_once(timeline, Window(0, ns(2.7))) == 2
    assert threads_at_once(timeline, Window(0, ns(2.5))) == 1
    busy = statistics(timeline, Window(0, ns(2))).busy
    assert busy == {threads[0]: 0.5, threads[1]: 0.0, threads[2]: 0.0}


def test_an_empty_run_has_no_figures() -> None:
    figures = statistics(Timeline())
    assert (figures.callbacks, figures.busy, figures.threads_at_once) == ((), {}, 0)


@pytest.mark.parametrize(("per_cent", "value"), [(0, 1), (1, 1), (50, 10), (95, 19), (96, 20), (100, 20)])
def test_a_percentile_is_the_nearest_rank(per_cent: int, value: int) -> None:
    assert percentile(range(1, 21), per_cent) == value


@given(st.lists(st.integers(-50, 50)))
def test_a_distribution_is_of_values_that_occur(values: list[int]) -> None:
    found = distribution(values)
    if not values:
        assert found is None
        return
    assert found is not None
    assert (found.count, found.least, found.most) == (len(values), min(values), max(values))
    for per_cent, value in ((50, found.median), (95, found.p95)):
        assert value == naive_percentile(values, per_cent)


def naive_percentile(values: list[int], per_cent: int) -> int:
    """The smallest value that enough of the values do not exceed."""
    enough = [v for v in values if sum(w <= v for w in values) * 100 >= per_cent * len(values)]
    return min(enough)


def naive_distribution(values: list[int]) -> Distribution | None:
    if not values:
        return None
    median, p95 = naive_percentile(values, 50), naive_percentile(values, 95)
    return Distribution(len(values), min(values), median, p95, max(values))


@given(legal_runs(), st.integers(0, 120), st.integers(0, 200))
def test_the_figures_of_a_random_run_are_those_of_a_naive_search(
    events: list[AnyEvent], start: int, length: int
) -> None:
    timeline, naive = timeline_of(events), Naive(events)
    window = Window(start, start + length)
    for entity in GROUP_OF:
        figures = run_to_end(statistics_incrementally(timeline, entity, window))
        assert_as_naive(figures, naive, entity, window)
        if KINDS[entity] is EntityKind.TIMER:
            calls = [s for s in naive.spans if s.entity == entity and window.start <= s.start < window.end]
            begun = [span for span in calls if not resumed(naive, span)]
            assert ages_used(timeline, figures.entity, window) == naive_used(naive, begun)
    assert threads_at_once(timeline, window) == max(
        (naive_at_once(naive, at, window) for at in moments_in(naive, window)), default=0
    )


def assert_as_naive(figures: CallbackStatistics, naive: Naive, entity: EntityId, window: Window) -> None:
    stretches = [s for s in naive.spans if s.entity == entity and window.start <= s.start < window.end]
    calls = [span for span in stretches if not resumed(naive, span)]
    assert figures.calls == len(calls)
    ended = [(s.start, s.end) for s in stretches if s.end is not None and s.end < window.end]
    assert figures.duration == naive_distribution([end - start for start, end in ended])
    assert figures.wait == naive_distribution(naive_waits(naive, calls, entity, window))
    assert figures.drops == naive.drops(window, entity)
    assert figures.errors == sum(bool(span.error) for span in stretches)
    called = [span.age for span in calls]
    pending = naive_pending(naive, entity, window)
    ages = naive_distribution([*called, *(age for age in pending if age > max(called, default=0))])
    timer = KINDS[entity] is EntityKind.TIMER
    assert (figures.age, figures.late) == ((None, ages) if timer else (ages, None))
    assert figures.jitter == naive_jitter(calls, KINDS[entity])


def resumed(naive: Naive, span: Span) -> bool:
    """Whether a span is not the first of its call: the n-th span belongs to the n-th start or resumption."""
    begun = [event for event in naive.events if isinstance(event, CallbackStarted | CallbackResumed)]
    place = next(place for place, each in enumerate(naive.spans) if each is span)
    return isinstance(begun[place], CallbackResumed)


def naive_waits(naive: Naive, calls: list[Span], entity: EntityId, window: Window) -> list[int]:
    waits = naive.waits_of(entity, Window(window.start - 1, window.end))
    over = [
        (wait.end, naive_length(naive, wait, wait.end))
        for place, wait in enumerate(waits)
        if wait.end is not None
        and not any(later.since == wait.since for later in waits[place + 1 : place + 2])
    ]
    found: list[int] = []
    for place, call in enumerate(calls):
        before = calls[place - 1].start if place else -(10**9)
        mine = [length for end, length in over if before < end <= call.start]
        found.append(mine[-1] if mine else 0)
    return found


def naive_length(naive: Naive, wait: Wait, end: int) -> int:
    """How long a callback, or the message that it takes at the end or is to take next, has waited by then."""
    kept_since, is_own = wait.since, wait.is_for_own_call
    series = [each for each in naive.waits if (each.entity, each.since) == (wait.entity, wait.since)]
    if series[0].is_for_own_call and series[0].end is not None and not is_own:
        arrived = naive.queue(wait.entity, series[0].end).next_arrived
        kept_since = wait.since if arrived is None else min(arrived, series[0].end)
    messages = naive.queue(wait.entity, max(wait.start, end - 1)).messages
    if not messages:
        return end - kept_since
    arrived = messages[0].arrived
    begun = [each for each in naive.spans if (each.entity, each.start) == (wait.entity, end)]
    calls = [each for each in begun if not resumed(naive, each)]
    if wait.end == end and calls:
        arrived = next((each.arrived for each in messages if each.id == calls[0].message), end)
    return end - (arrived if is_own else min(arrived, kept_since))


def naive_pending(naive: Naive, entity: EntityId, window: Window) -> list[int]:
    """How late a timer's call is that waits as the window ends, or how old what another one waits for."""
    end = min(window.end, max((event.t for event in naive.events), default=0))
    waits = [end - wait.since for at, wait in naive.waiting(window.end - 1).items() if at == entity]
    return [end - message.since for message in naive.queue(entity, window.end - 1).messages[:1]] or waits


def naive_jitter(calls: list[Span], kind: EntityKind) -> Distribution | None:
    if kind is EntityKind.TIMER:
        return naive_distribution([abs(b.start - a.start) for a, b in pairwise(calls)])
    if kind is EntityKind.SUBSCRIPTION:
        steps = [b.start - b.age - (a.start - a.age) for a, b in pairwise(calls)]
        middle = sorted(steps)[ceil(len(steps) / 2) - 1] if steps else 0
        return naive_distribution([abs(step - middle) for step in steps])
    return None


def naive_used(naive: Naive, calls: list[Span]) -> dict[EntityId, Distribution]:
    used = {}
    for entity, kind in KINDS.items():
        ages = []
        for call in calls:
            taken = [s.start - s.age for s in naive.spans if s.entity == entity and s.start <= call.start]
            if taken:
                ages.append(call.start - max(taken))
        figures = naive_distribution(ages)
        if kind is EntityKind.SUBSCRIPTION and figures is not None:
            used[entity] = figures
    return used


def moments_in(naive: Naive, window: Window) -> set[int]:
    """When something began, and when the window does: at no other moment are there more at once."""
    return {span.start for span in naive.spans if span.start < window.end}


def naive_at_once(naive: Naive, at: int, window: Window) -> int:
    """The threads that run at a moment; a call without length needs one beside those that go on."""
    busy = [stretches_of(naive, thread, window) for thread in THREADS]
    lasting = sum(any(start <= at < end for start, end in stretches) for stretches in busy)
    going_on = sum(any(start < at < end for start, end in stretches) for stretches in busy)
    instant = any((at, at) in stretches for stretches in busy)
    return max(lasting, going_on + instant)


def stretches_of(naive: Naive, thread: int, window: Window) -> list[tuple[int, int]]:
    """When a thread ran anything that reaches into the window; what touches is one stretch."""
    joined: list[tuple[int, int]] = []
    for span in sorted(naive.spans, key=lambda span: span.start):
        end = span.end_at(window.end)
        if span.thread != thread or not (span.start < window.end and max(end, span.start + 1) > window.start):
            continue
        if joined and span.start <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        else:
            joined.append((span.start, end))
    return joined
