"""A timeline that keeps next to nothing in memory answers like one that keeps all."""

import tracemalloc
from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.trace import run_stores
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackStarted,
    EntityReady,
    Logged,
    MessageDropped,
    Printed,
    Published,
    Reason,
    RequestLost,
    RobotMoved,
    Scanned,
    ServiceCalled,
    ServiceReplied,
    Severity,
    VelocityCommanded,
    WaitEnded,
    WaitStarted,
)
from sim.trace.model import Window
from sim.trace.service_calls import NEWEST_KEPT
from sim.trace.storage.spill_file import SpillFile
from sim.trace.timeline import Timeline
from tests.support.daily import first_daily
from tests.trace.naive import Naive, overlaps
from tests.trace.systems import jumbled_runs, legal_runs
from tests.trace.test_timeline_properties import (
    assert_same_answers,
    assert_same_moment,
    assert_same_window,
    several,
    timeline_of,
    times,
    windows,
)

ALWAYS = Window(0, 10**15)


def spilling(entries: int) -> Timeline:
    """A timeline of blocks of so many entries, of which a few are at hand."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run_stores, "SpillFile", partial(SpillFile, cache_size=300, entries=entries))
        return Timeline()


def forgetful(events: list[AnyEvent]) -> Timeline:
    """A timeline that has two or three entries of every kind in memory."""
    timeline = spilling(entries=2)
    timeline.extend(events)
    return timeline


def busy(first: int, after: int) -> list[AnyEvent]:
    """Messages, each of which brings an event of every frequent kind."""
    return [event for number in range(first, after) for event in delivery(number * 1000, number)]


def delivery(t: int, message: int) -> list[AnyEvent]:
    return [
        Published(t, message, "/scan", 0, 0),
        Scanned(t, message, message.to_bytes(4, "little") * 30),
        EntityReady(t, 1, 1, message),
        EntityReady(t, 2, 1, message),
        MessageDropped(t + 1, 2, 0, message),
        WaitStarted(t + 1, 1, t, Reason.GROUP_HELD, 2, False),
        WaitEnded(t + 5, 1),
        CallbackStarted(t + 5, 1, 1, message, 5, 0),
        ServiceCalled(t + 6, message, "/motors", 1, f"request {message}"),
        Logged(t + 7, Severity.INFO, "node", f"at {t}", 1, 1),
        Printed(t + 8, f"printed {t}", False),
        ServiceReplied(t + 9, message, "/motors", f"response {message}"),
        CallbackEnded(t + 10, 1, 1),
        RobotMoved(t + 11, t, 0.0, 0.0, 1.0, 0.1, 0.0, True, False, 0.0, t),
        VelocityCommanded(t + 12, 0.1, message),
    ]


@given(legal_runs(), several)
def test_moments_and_windows_of_a_spilled_run(events: list[AnyEvent], at: list[tuple[int, int]]) -> None:
    timeline, naive = forgetful(events), Naive(events)
    for time in times(events, at):
        assert_same_moment(timeline, naive, time)
        assert timeline.scan_seen(time) == naive.scan_seen(time)
    for window in windows(events, at):
        assert_same_window(timeline, naive, window)


@given(legal_runs(), several, st.sampled_from([1, -1]))
def test_neighbours_in_a_spilled_run(events: list[AnyEvent], at: list[tuple[int, int]], step: int) -> None:
    timeline, naive = forgetful(events), Naive(events)
    for time in times(events, at):
        assert timeline.neighbour(time, step) == naive.neighbour(time, step)


@given(jumbled_runs(), several)
def test_a_spilled_run_may_be_recorded_a_little_out_of_order(
    runs: tuple[list[AnyEvent], list[AnyEvent]], at: list[tuple[int, int]]
) -> None:
    events, jumbled = runs
    assert_same_answers(forgetful(jumbled), timeline_of(events), events, at)


def test_all_that_was_told_is_there_though_spilled() -> None:
    events = busy(1, 40)
    timeline, whole = forgetful(events), timeline_of(events)
    assert_same_answers(timeline, whole, events, [(place, 0) for place in range(0, len(events), 7)])
    for t in range(0, 40_000, 777):
        assert timeline.command(t) == whole.command(t)
        assert timeline.scan(t) == whole.scan(t)
    assert [log.text for log in timeline.logs] == [
        text for t in range(1000, 40_000, 1000) for text in (f"at {t}", f"printed {t}")
    ]
    assert timeline.calls[-1] == whole.calls[-1]
    assert timeline.calls[0].response == "response 1"


def test_an_event_that_comes_very_late_finds_its_place() -> None:
    early, rest = busy(1, 3), busy(3, 30)
    timeline = forgetful([event for event in rest + early if isinstance(event, Logged | RobotMoved)])
    assert [log.t for log in timeline.logs] == [number * 1000 + 7 for number in range(1, 30)]
    assert [robot.t for robot in timeline.trail(ALWAYS)] == [number * 1000 + 11 for number in range(1, 30)]


@given(legal_runs(), several)
def test_calls_within_a_window_were_out_at_some_time_in_it(
    events: list[AnyEvent], at: list[tuple[int, int]]
) -> None:
    for timeline in (timeline_of(events), forgetful(events)):
        assert list(timeline.services_called) == list(dict.fromkeys(call.service for call in timeline.calls))
        for window in windows(events, at):
            assert timeline.calls_within(window) == [
                call for call in timeline.calls if overlaps(call.sent, call.replied, window)
            ]


@pytest.mark.parametrize("later", first_daily(0, 2 * NEWEST_KEPT))
def test_a_call_is_answered_or_lost_however_many_came_after_it(later: int) -> None:
    sent = [ServiceCalled(number, number, "/motors", 0, "on") for number in range(1, 3 + later)]
    timeline = forgetful(
        [*sent, ServiceReplied(10_000, 1, "/motors", "done"), RequestLost(10_000, 2, "/motors")]
    )
    first, second = timeline.calls[:2]
    assert (first.replied, first.response, first.lost) == (10_000, "done", False)
    assert (second.replied, second.response, second.lost) == (None, "", True)


def test_a_callback_that_ends_when_its_begin_is_spilled_has_its_end() -> None:
    events = [CallbackStarted(500, 9, 9, 0, 0, 0), *busy(1, 30), CallbackEnded(10**6, 9, 9)]
    (span,) = forgetful(events).spans_on(9, ALWAYS)
    assert (span.start, span.end) == (500, 10**6)


@pytest.mark.slow
def test_memory_does_not_grow_with_the_run() -> None:
    timeline = spilling(entries=64)
    tracemalloc.start()
    timeline.extend(busy(1, 1500))
    before, _ = tracemalloc.get_traced_memory()
    events = 0
    for first in range(1500, 3500, 100):
        batch = busy(first, first + 100)
        events += len(batch)
        timeline.extend(batch)
    del batch
    after, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert (after - before) / events < 12
