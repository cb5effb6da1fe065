"""Events in order of time, without losing or changing any but those that come too late."""

from hypothesis import given
from hypothesis import strategies as st

from sim.export.reorder_buffer import PayloadKind, ReorderBuffer
from sim.trace.events import AnyEvent, EntityAppeared, EntityKind, EntityReady, WaitStarted
from tests.support.runs import Run, ns
from tests.trace.systems import jumbled_runs


def through(order: ReorderBuffer, events: list[AnyEvent], size: int) -> list[AnyEvent]:
    taken = [event for at in range(0, len(events), size) for event in order.take(events[at : at + size])]
    return [*taken, *order.flush()]


@given(jumbled_runs(), st.integers(1, 20), st.integers(1, 40))
def test_nothing_is_lost_and_times_never_fall(
    runs: tuple[list[AnyEvent], list[AnyEvent]], size: int, horizon: int
) -> None:
    events, jumbled = runs
    told = through(ReorderBuffer(horizon), jumbled, size)
    assert len(told) == len(events)
    assert [event.t for event in told] == sorted(event.t for event in told)


@given(jumbled_runs(), st.integers(1, 20))
def test_what_comes_in_time_stays_what_it_is(runs: tuple[list[AnyEvent], list[AnyEvent]], size: int) -> None:
    _, jumbled = runs
    unmoved: list[AnyEvent] = [event for event in jumbled if not isinstance(event, WaitStarted)]
    assert through(ReorderBuffer(10**9), unmoved, size) == sorted(unmoved, key=lambda event: event.t)


def test_what_comes_too_late_moves_to_what_was_told_last() -> None:
    run = Run()
    run.log("early", 0.5)
    run.log("on time", 9.0)
    order = ReorderBuffer(ns(1))
    told = [*order.take([event for event in run.events if event.t > 0])]
    late = Run()
    late.log("late", 0.1)
    told += order.take(late.events[1:])
    told += order.flush()
    assert [event.t for event in told] == [ns(0.5), ns(0.5), ns(9.0)]


def test_who_receives_a_message_is_known_ahead_and_told_once() -> None:
    order = ReorderBuffer(ns(1))
    appeared = EntityAppeared(0, 1, 1, 1, EntityKind.SERVICE, "/s", "serve", "", 0, 0, 10, 0)
    order.take([appeared, EntityReady(5, 1, 1, 7), EntityReady(6, 2, 1, 7)])
    assert order.receivers(PayloadKind.REQUEST, 7) == [1]
    assert order.receivers(PayloadKind.MESSAGE, 7) == [2]
    assert order.receivers(PayloadKind.MESSAGE, 7) == ()
