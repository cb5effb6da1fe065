"""The time axis: easy steps, a grid that stands still, labels that belong to their columns."""

from hypothesis import given
from hypothesis import strategies as st

from cbtui.widgets.lanes.scale import labels, nice_column, scale_for
from sim.trace.model import Window
from tests.support.runs import ns

windows = st.builds(
    lambda start, length: Window(start, start + length),
    st.integers(-ns(10), ns(3600)),
    st.integers(1, ns(3600)),
)


@given(windows, st.integers(1, 200))
def test_a_scale_shows_the_whole_window(window: Window, columns: int) -> None:
    shown = scale_for(window, columns).window
    assert shown.end >= window.end
    assert shown.start <= window.start + scale_for(window, columns).per_column


@given(windows, st.integers(1, 200), st.integers(0, 10**10))
def test_moving_a_window_moves_the_picture_by_whole_columns(window: Window, columns: int, by: int) -> None:
    before = scale_for(window, columns)
    after = scale_for(Window(window.start + by, window.end + by), columns)
    assert before.per_column == after.per_column
    assert before.time_at(0) % before.per_column == 0
    assert after.time_at(0) % after.per_column == 0


@given(windows, st.integers(1, 200))
def test_labels_name_a_moment_of_their_column(window: Window, columns: int) -> None:
    scale = scale_for(window, columns)
    for column, text in labels(scale):
        assert 0 <= column < columns
        assert scale.column_of(ns(float(text))) == column


@given(st.integers(1, 10**14))
def test_columns_are_little_longer_than_needed(least: int) -> None:
    assert least <= nice_column(least) <= least * 1.3 + 1


def test_ten_seconds_in_fifty_columns_are_200_ms_a_column() -> None:
    scale = scale_for(Window(ns(4.25), ns(14.25)), 50)
    assert scale.per_column == ns(0.2)
    assert labels(scale) == [(8, "6"), (18, "8"), (28, "10"), (38, "12"), (48, "14")]
