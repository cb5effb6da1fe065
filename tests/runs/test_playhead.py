from hypothesis import given
from hypothesis import strategies as st

from cbtui.runs.live.playhead import SPANS, Playhead
from sim.trace.model import Window
from tests.support.builder import ns
from tests.support.runs import dummy_server_run, shared_group_run
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


@given(st.integers(0, 10**12), st.lists(st.integers(-3, 3)))
def test_zooming_stays_within_the_known_spans(end: int, steps: list[int]) -> None:
    playhead = Playhead()
    for step in steps:
        playhead = playhead.zoomed(step, end)
        assert playhead.span in SPANS


def test_a_screen_shows_from_a_millisecond_to_ten_minutes() -> None:
    assert SPANS[0] == SECOND // 1000
    assert SPANS[-1] == 600 * SECOND
    assert list(SPANS) == sorted(set(SPANS))


@given(st.integers(0, 10**12), st.lists(st.integers(-40, 40)))
def test_a_moved_cursor_is_on_screen_and_never_after_the_end(end: int, moves: list[int]) -> None:
    playhead = Playhead()
    for move in moves:
        playhead = playhead.moved(move, end)
        now, window = playhead.now(end), playhead.window(end)
        assert 0 <= now <= end
        assert window.start <= now <= window.end
        assert window.length == playhead.span


def played(playhead: Playhead, key: str, amount: int, end: int) -> Playhead:
    """What a key does to a playhead."""
    match key:
        case "scrub":
            return playhead.moved(amount, end)
        case "pan":
            return playhead.panned(amount, end)
        case "zoom":
            return playhead.zoomed(amount, end)
        case "seek":
            return playhead.moved_to(end * amount // 20, end)
    return playhead.live()


KEYS = st.tuples(st.sampled_from(["scrub", "pan", "zoom", "seek", "live"]), st.integers(-20, 20))
GROWTH = st.integers(0, 3 * SECOND)


@given(st.integers(0, 10**12), st.lists(st.tuples(KEYS, GROWTH), max_size=30))
def test_whatever_is_pressed_cursor_and_stretch_stay_within_the_run(
    end: int, keys: list[tuple[tuple[str, int], int]]
) -> None:
    playhead = Playhead()
    for (key, amount), growth in keys:
        playhead = played(playhead, key, amount, end)
        window = playhead.window(end)
        assert 0 <= playhead.now(end) <= end
        assert 0 <= window.start <= end
        assert window.length == playhead.span
        assert not playhead.follows or window.end == max(end, playhead.span)
        end += growth


@given(st.integers(0, 10**12), st.lists(KEYS, max_size=12), st.integers(-20, 20))
def test_panning_leaves_the_cursor_where_it_is(end: int, keys: list[tuple[str, int]], steps: int) -> None:
    playhead = Playhead()
    for key, amount in keys:
        playhead = played(playhead, key, amount, end)
    assert playhead.panned(steps, end).now(end) == playhead.now(end)


@given(st.integers(0, 10**12), st.lists(KEYS, max_size=12), st.integers(-4, 4))
def test_zooming_keeps_a_cursor_on_screen_that_was_there(
    end: int, keys: list[tuple[str, int]], steps: int
) -> None:
    playhead = Playhead()
    for key, amount in keys:
        playhead = played(playhead, key, amount, end)
    now, shown = playhead.now(end), playhead.window(end)
    zoomed = playhead.zoomed(steps, end)
    after = zoomed.window(end)
    assert zoomed.now(end) == now
    if shown.start <= now <= shown.end:
        assert after.start <= now <= after.end


def test_a_stretch_that_was_panned_stands_still_while_the_run_goes_on() -> None:
    panned = Playhead().panned(-3, 20 * SECOND)
    assert panned.window(20 * SECOND) == panned.window(30 * SECOND) == Window(7 * SECOND, 17 * SECOND)
    assert panned.now(30 * SECOND) == 30 * SECOND
    assert not panned.follows


def test_panning_back_to_the_end_follows_it_again() -> None:
    assert Playhead().panned(-3, 20 * SECOND).panned(3, 20 * SECOND) == Playhead()


def test_a_cursor_moves_within_the_stretch_and_takes_it_along_at_its_edges() -> None:
    end = 60 * SECOND
    back = Playhead().moved(-5, end)
    assert (back.now(end), back.window(end)) == (55 * SECOND, Window(50 * SECOND, 60 * SECOND))
    further = back.moved(-6, end)
    assert (further.now(end), further.window(end)) == (49 * SECOND, Window(48 * SECOND, 58 * SECOND))


def test_a_far_moment_is_shown_in_the_middle() -> None:
    moved_to = Playhead().moved_to(20 * SECOND, 60 * SECOND)
    assert moved_to.window(60 * SECOND) == Window(15 * SECOND, 25 * SECOND)


def test_a_moment_is_sought_between_the_beginning_and_the_end() -> None:
    end = 20 * SECOND
    assert Playhead().moved_to(7 * SECOND, end).at == 7 * SECOND
    assert Playhead().moved_to(-5, end).at == 0
    assert Playhead().moved_to(end, end).at is None
    assert Playhead(at=3).moved_to(30 * SECOND, end).at is None


def test_events_are_gone_through_one_by_one_both_ways() -> None:
    timeline = told(dummy_server_run())
    back, places = Playhead(), []
    while (further := back.beside([timeline], timeline.end, -1)) != back:
        back = further
        places.append(back.at)
    assert places == sorted(places, key=lambda at: -(at or 0))
    assert len(places) > 5
    forth = []
    while back.at is not None:
        forth.append(back.at)
        back = back.beside([timeline], timeline.end, 1)
    assert forth == places[::-1]


def test_events_of_two_runs_are_gone_through_together() -> None:
    first, second = told(dummy_server_run()), told(shared_group_run())
    end = max(first.end, second.end)
    both = [timeline.neighbour(ns(5.0), -1) for timeline in (first, second)]
    assert Playhead(at=ns(5.0)).beside([first, second], end, -1).at == max(at or 0 for at in both)
    assert len(set(both)) == 2
