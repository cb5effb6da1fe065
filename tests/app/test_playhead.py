from hypothesis import given
from hypothesis import strategies as st

from cbtui.playhead import SPANS, Playhead
from sim.trace.model import Window
from tests.support.builder import ns
from tests.support.runs import dummy_server_run
from tests.widgets.pictures import told

SECOND = 1_000_000_000


def test_a_live_playhead_follows_the_end() -> None:
    assert Playhead().now(3 * SECOND) == 3 * SECOND
    assert Playhead().window(25 * SECOND) == Window(15 * SECOND, 25 * SECOND)


def test_a_young_run_is_shown_from_its_beginning() -> None:
    assert Playhead().window(3 * SECOND) == Window(0, 10 * SECOND)


def test_looking_back_stands_still_while_the_run_goes_on() -> None:
    back = Playhead().moved(-2, end=20 * SECOND)
    assert back.now(20 * SECOND) == back.now(30 * SECOND) == 18 * SECOND


def test_moving_past_the_end_is_live_again() -> None:
    assert Playhead().moved(-1, end=20 * SECOND).moved(1, end=20 * SECOND).at is None


def test_nothing_lies_before_the_beginning() -> None:
    assert Playhead().moved(-1000, end=20 * SECOND).now(20 * SECOND) == 0


@given(st.lists(st.integers(-3, 3)))
def test_zooming_stays_within_the_known_spans(steps: list[int]) -> None:
    playhead = Playhead()
    for step in steps:
        playhead = playhead.zoomed(step)
        assert playhead.span in SPANS


@given(st.integers(0, 10**12), st.lists(st.integers(-40, 40)))
def test_now_is_always_on_screen_and_never_after_the_end(end: int, moves: list[int]) -> None:
    playhead = Playhead()
    for move in moves:
        playhead = playhead.moved(move, end)
    now, window = playhead.now(end), playhead.window(end)
    assert 0 <= now <= end
    assert window.start <= now <= window.end
    assert window.length == playhead.span


def test_a_moment_is_sought_between_the_beginning_and_the_end() -> None:
    end = 20 * SECOND
    assert Playhead().sought(7 * SECOND, end).at == 7 * SECOND
    assert Playhead().sought(-5, end).at == 0
    assert Playhead().sought(end, end).at is None
    assert Playhead(at=3).sought(30 * SECOND, end).at is None


def test_events_are_gone_through_one_by_one_both_ways() -> None:
    timeline = told(dummy_server_run())
    back, places = Playhead(), []
    while (further := back.beside(timeline, -1)) != back:
        back = further
        places.append(back.at)
    assert places == sorted(places, key=lambda at: -(at or 0))
    assert len(places) > 5
    forth = []
    while back.at is not None:
        forth.append(back.at)
        back = back.beside(timeline, 1)
    assert forth == places[::-1]


def test_events_of_one_callback_are_gone_through_alone() -> None:
    timeline = told(dummy_server_run())
    entity = next(iter(timeline.entities))
    found = timeline.neighbour(ns(5.0), entity, -1)
    assert found is not None
    assert Playhead(at=ns(5.0)).beside(timeline, -1, entity).at == found
