"""Summing up intervals column by column: nothing long is lost, and what is kept stays true."""

from collections.abc import Sequence
from dataclasses import dataclass

from hypothesis import given
from hypothesis import strategies as st

from cbtui.widgets.lanes.columns import (
    SAMPLES_PER_COLUMN,
    InstantColumns,
    IntervalBudget,
    LaneColumns,
    stretches,
)
from cbtui.widgets.lanes.scale import TimeScale
from sim.trace.lazy import LazySequence
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.runs import Run, ns

S = 1_000_000_000


@dataclass
class Stay:
    start: int
    end: int | None
    entity: int = 1


class Store:
    """Intervals that answer as a timeline does."""

    def __init__(self, *stays: Stay) -> None:
        self.stays = list(stays)

    def query(self, window: Window) -> list[Stay]:
        found = [
            one
            for one in self.stays
            if one.start < window.end
            and (one.start >= window.start or one.end is None or one.end > window.start)
        ]
        return sorted(found, key=lambda one: one.start)


intervals = st.lists(
    st.builds(
        lambda start, length: Stay(start, start + length), st.integers(0, 20 * S), st.integers(0, 5 * S)
    ),
    max_size=12,
)


@given(intervals, st.integers(-5, 30))
def test_a_column_is_lit_exactly_where_something_ran(stays: list[Stay], first: int) -> None:
    store = Store(*stays)
    scale = TimeScale(first, S, 10)
    for place, column in enumerate(LaneColumns(store.query).over(scale, 40 * S)):
        assert (column is not None) == bool(
            store.query(Window(scale.time_at(place), scale.time_at(place + 1)))
        )


def test_more_of_a_column_taken_means_more_eighths() -> None:
    store = Store(Stay(0, S // 4), Stay(S, 2 * S), Stay(2 * S, 2 * S))
    assert [
        column and column.eighths for column in LaneColumns(store.query).over(TimeScale(0, S, 4), 9 * S)
    ] == [
        2,
        8,
        1,
        None,
    ]


def test_a_long_call_is_found_among_very_many_short_ones() -> None:
    short = [Stay(place * 1000, place * 1000 + 10) for place in range(20 * SAMPLES_PER_COLUMN)]
    long = Stay(7003, 3 * S)
    columns = LaneColumns(Store(*short, long).query).over(TimeScale(0, S, 4), 9 * S)
    assert [column.top is long if column else None for column in columns] == [False, True, True, None]


def test_an_interval_is_made_once_for_a_look_at_its_column() -> None:
    store = Store(*(Stay(place * S // 2 + 1, place * S // 2 + 2) for place in range(20)))
    made: list[int] = []

    def query(window: Window) -> Sequence[Stay]:
        found = store.query(window)
        return LazySequence(range(len(found)), lambda row: made.append(row) or found[row])  # type: ignore[func-returns-value]

    LaneColumns(query).over(TimeScale(0, S, 10), 11 * S)
    assert made == list(range(20))


def test_many_short_calls_take_as_much_of_a_column_as_all_of_them_do() -> None:
    half = [Stay(place * S // 200, place * S // 200 + S // 400) for place in range(200)]
    (column,) = LaneColumns(Store(*half).query).over(TimeScale(0, S, 1), 9 * S)
    assert column is not None
    assert 3 <= column.eighths <= 5


def test_what_still_lasts_reaches_to_the_edge() -> None:
    columns = LaneColumns(Store(Stay(S, None)).query)
    assert [column and column.eighths for column in columns.over(TimeScale(0, S, 5), 3 * S + S // 2)] == [
        None,
        8,
        8,
        4,
        None,
    ]
    assert [column and column.eighths for column in columns.over(TimeScale(0, S, 5), 4 * S)] == [
        None,
        8,
        8,
        8,
        1,
    ]


def test_several_at_once_are_counted() -> None:
    store = Store(Stay(0, 3 * S), Stay(S, 2 * S, 2), Stay(2 * S, 2 * S, 3))
    assert [
        column and column.at_once for column in LaneColumns(store.query).over(TimeScale(0, S, 4), 9 * S)
    ] == [
        1,
        2,
        2,
        None,
    ]


def test_a_wait_told_late_is_shown_from_its_beginning() -> None:
    store = Store()
    columns = LaneColumns(store.query)
    assert not any(columns.over(TimeScale(0, S, 10), 8 * S))
    store.stays.append(Stay(2 * S, None))
    lit = [place for place, column in enumerate(columns.over(TimeScale(0, S, 10), 9 * S)) if column]
    assert lit == list(range(2, 10))


@given(intervals, st.lists(st.integers(1, 25), min_size=1, max_size=8))
def test_a_picture_is_the_same_whatever_was_painted_before(stays: list[Stay], edges: list[int]) -> None:
    store = Store(*stays)
    kept = LaneColumns(store.query)
    for edge in sorted(edges):
        scale = TimeScale(edge - 10, S, 12)
        assert kept.over(scale, 30 * S) == LaneColumns(store.query).over(scale, 30 * S)


@given(intervals, st.lists(st.tuples(st.integers(10, 30), st.sampled_from([S // 2, S, 2 * S])), max_size=8))
def test_a_picture_is_the_same_when_one_zooms_out_and_in_again(
    stays: list[Stay], looks: list[tuple[int, int]]
) -> None:
    store = Store(*stays)
    kept = LaneColumns(store.query)
    for edge, length in sorted(looks):
        scale = TimeScale(edge * S // length - 10, length, 12)
        assert kept.over(scale, 30 * S) == LaneColumns(store.query).over(scale, 30 * S)


@given(intervals, st.integers(1, 30))
def test_what_a_ration_leaves_out_comes_with_the_next_pictures(stays: list[Stay], looks: int) -> None:
    store = Store(*stays)
    columns, scale = LaneColumns(store.query), TimeScale(0, S, 24)
    whole = LaneColumns(store.query).over(scale, 30 * S)
    for _ in range(12):
        summed = columns.over(scale, 30 * S, IntervalBudget(looks))
        assert all(summed[place] is None for place in columns.unseen)
        seen = [place for place in range(24) if place not in columns.unseen]
        assert [summed[place] for place in seen] == [whole[place] for place in seen]
    assert not columns.unseen


def test_columns_that_change_stay_as_they_were_until_the_ration_reaches_them() -> None:
    long = Stay(2 * S, None)
    store = Store(long, *(Stay(place * S, place * S + 1, 2) for place in range(24)))
    columns, scale = LaneColumns(store.query), TimeScale(0, S, 24)
    before = columns.over(scale, 24 * S)
    long.end = 20 * S
    summed = columns.over(scale, 24 * S, IntervalBudget(10))
    assert columns.is_behind
    assert not columns.unseen
    assert summed[:8] == before[:8]
    assert columns.over(scale, 24 * S) == LaneColumns(store.query).over(scale, 24 * S)
    assert not columns.is_behind


def test_what_is_kept_is_not_examined_again_while_older_columns_are_missing_and_time_goes_on() -> None:
    asked: list[Window] = []
    store = Store(*(Stay(place * S, place * S + 1) for place in range(400)))

    def query(window: Window) -> list[Stay]:
        asked.append(window)
        return store.query(window)

    columns = LaneColumns(query)
    for now in range(300, 310):
        asked.clear()
        columns.over(TimeScale(now - 200, S, 200), 400 * S, IntervalBudget(10))
        assert columns.unseen
        assert max(window.length for window in asked) <= 12 * S


def test_neighbouring_columns_of_one_interval_are_one_stretch() -> None:
    store = Store(Stay(S, 4 * S), Stay(4 * S, 6 * S, 2), Stay(8 * S, 8 * S))
    found = stretches(LaneColumns(store.query).over(TimeScale(0, S, 10), 20 * S))
    assert [(one.first, one.after) for one in found] == [(1, 4), (4, 6), (8, 9)]


def test_instants_are_found_in_their_columns_and_the_settled_past_is_asked_for_once() -> None:
    asked: list[Window] = []
    at = [ns(0.05), ns(3.0), ns(3.05), ns(7.2)]

    def query(window: Window) -> list[int]:
        asked.append(window)
        return [each for each in at if window.start <= each < window.end]

    instants = InstantColumns(query)
    assert instants.over(TimeScale(0, ns(0.1), 50), ns(4.0)) == [0, 30]
    assert instants.over(TimeScale(30, ns(0.1), 50), ns(8.0)) == [0, 42]
    assert asked[-1].start == ns(3.9)


@given(
    st.lists(st.integers(0, 400), max_size=30), st.lists(st.tuples(st.integers(0, 300), st.integers(1, 9)))
)
def test_instants_are_the_same_whatever_was_asked_before(
    at: list[int], scales: list[tuple[int, int]]
) -> None:
    times = sorted(ns(each / 10) for each in at)

    def query(window: Window) -> list[int]:
        return [each for each in times if window.start <= each < window.end]

    used, edge = InstantColumns(query), ns(41)
    for first, tenths in scales:
        scale = TimeScale(first, ns(tenths / 10), 40)
        assert used.over(scale, edge) == InstantColumns(query).over(scale, edge)


def test_a_column_of_what_lasted_is_summed_up_anew_when_it_has_ended() -> None:
    timeline, scale = Timeline(), TimeScale(0, ns(0.1), 50)
    run = Run()
    thread = run.thread("MainThread")
    timer = run.timer(run.exclusive(run.node("/n")), "tick_callback", 1.0)
    run.callback(timer, thread, 0.5, 2.5)
    timeline.extend(event for event in run.events if event.t < ns(3))
    columns = LaneColumns(lambda window: timeline.spans_on(thread, window))
    before = columns.over(scale, ns(2.9))[10]
    assert before is not None
    assert before.top.end is None
    timeline.extend(event for event in run.events if event.t >= ns(3))
    after = columns.over(scale, ns(3.4))[10]
    assert after is not None
    assert after.top.end == ns(3.0)
