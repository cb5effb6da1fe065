"""Lanes as text: what runs, what waits and why can be read without a colour."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.cells import cell_len

from cbtui.looks.theme import Charset, Role
from cbtui.widgets.lanes import LanePainter, wanted_rows
from cbtui.widgets.lanes.painter import INTERVALS_PER_FRAME
from cbtui.widgets.lanes.rows import GroupLane, MemberLane, ServiceLane, SoleLane, ThreadLane
from sim.trace.events import Reason, TimerCancelled, TimerReset
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.properties import examples
from tests.support.runs import (
    Run,
    ns,
    shared_group_run,
    split_groups_run,
)
from tests.widgets.pictures import (
    drawn,
    dummy_server,
    dummy_server_one_thread,
    last,
    plain,
    shared_group,
    split_groups,
    told,
)

RUNS = (shared_group, split_groups, dummy_server, Timeline)


def small_run() -> tuple[Run, int, int, int]:
    """One thread, an exclusive group with a subscription ``a`` and a timer; return run, thread, a, timer."""
    run = Run()
    thread = run.thread("MainThread")
    group = run.exclusive(run.node("/n"))
    return run, thread, run.subscription(group, "/a", "a_callback"), run.timer(group, "tick_callback", 1.0)


def test_one_shared_group_shows_everybody_waiting_for_the_timer() -> None:
    timeline = shared_group(12.9)
    assert plain(LanePainter().paint(timeline, *last(10, 12.9), 80, 8).rows) == drawn(
        """
        |MainThread  │▎▎▎▎▎A timer_callback ███████████████████████████▌│  90% busy      |
        |A exclusive │·····── held by timer_callback on MainThread ─────│ held, 2 wait   |
        |  odom      │▎▎▎▎▎╱╱ waits 8.9 s: A held by timer_callback ××××│ 10/10! lost 168|
        |  scan      │▎▎▎▎▎╱╱ waits 8.9 s: A held by timer_callback ××××│ 10/10! lost 168|
        |  timer     │▎ ▎  ── runs 8.9 s on MainThread ─────────────────│ late 8.4 s     |
        |seconds     │     4         6         8         10         now▲│ 200 ms/col     |
        """
    )


def test_words_and_figures_are_of_the_moment_that_is_told_and_bars_go_on() -> None:
    timeline = shared_group(12.9)
    window, now = last(10, 12.9)
    behind = plain(LanePainter().paint(timeline, window, now, 80, 8, told=ns(12.4)).rows)
    assert "odom      │▎▎▎▎▎╱╱ waits 8.4 s: A held by timer_callback ××××│ 10/10! lost 158" in behind
    assert "timer     │▎ ▎  ── runs 8.4 s on MainThread ─────────────────│ late 7.9 s" in behind
    assert "MainThread  │▎▎▎▎▎A timer_callback ███████████████████████████▌│" in behind


@pytest.mark.parametrize(
    ("name", "status"),
    [("count_all", "B count_all 7.9 s"), ("count_with_lock", "B count_wit… 7.9 s")],
)
def test_a_long_name_gives_way_to_how_long_its_callback_has_run(name: str, status: str) -> None:
    run, thread, _, _ = small_run()
    run.callback(run.timer(run.exclusive(run.node("/m")), name, 9.0), thread, 0.1)
    row, *_ = plain(LanePainter().paint(told(run), Window(0, ns(8.0)), ns(8.0), 120, 8).rows).splitlines()
    assert row.rpartition("%  ")[2].rstrip() == status


def test_once_a_call_is_over_its_label_tells_all_its_time_though_it_was_painted_when_less_was_told() -> None:
    run, thread, _, timer = small_run()
    run.callback(timer, thread, 0.5, 5.0)
    timeline, window = told(run), Window(0, ns(10.0))
    painter = LanePainter()
    behind = plain(painter.paint(timeline, window, ns(5.6), 80, 6, told=ns(5.4)).rows)
    assert "runs 4.9 s" in behind
    later = painter.paint(timeline, window, ns(6.0), 80, 6, told=ns(6.0)).rows
    assert later == LanePainter().paint(timeline, window, ns(6.0), 80, 6, told=ns(6.0)).rows
    assert "runs 5.0 s" in plain(later)


def test_a_label_in_the_past_tells_how_much_of_its_bar_is_over_but_not_if_it_begins_there() -> None:
    timeline = shared_group(12.9)
    window = Window(ns(3.0), ns(12.9))
    shown = plain(LanePainter().paint(timeline, window, ns(4.003), 80, 8).rows)
    assert "odom      │▎▎▎▎▎╱╱ group A held by timer_callback ××" in shown
    assert "scan      │▎▎▎▎▎╱╱ group A held by timer_callback ××" in shown
    assert "timer     │▎ ▎  ── runs 3.0 ms of 8.9 s on MainThread ──" in shown


@pytest.mark.parametrize(
    ("charset", "lines"), [(Charset.BRAILLE, "───────╶──────"), (Charset.ASCII, "------- ------")]
)
def test_a_long_call_right_after_another_begins_a_line_of_its_own(charset: Charset, lines: str) -> None:
    run, thread, _, tick = small_run()
    run.callback(tick, thread, 1.0, 1.4)
    run.callback(tick, thread, 2.4, 1.4)
    rows = plain(LanePainter(charset).paint(told(run), *last(10, 4.0), 80, 8).rows).splitlines()
    assert lines in next(row for row in rows if row.startswith("  tick"))


def test_what_has_no_callback_of_its_own_goes_by_its_name() -> None:
    run = Run()
    thread, group = run.thread("MainThread"), run.exclusive(run.node("/n"))
    action = run.client(group, "/turn/_action")
    run.subscription(group, "/a", "a_callback")
    run.callback(action, thread, 1.0, 9.0)
    text = plain(LanePainter().paint(told(run, until=10.0), *last(10, 10.0), 100, 8).rows)
    assert "A reply of /turn/_action" in text
    assert "held by reply of /turn/_action on MainThread" in text


def test_a_suspended_call_keeps_its_group_on_the_groups_lane() -> None:
    run, thread, _, timer = small_run()
    run.start(timer, thread, 1.0)
    run.suspend(timer, thread, 1.3)
    run.resume(timer, thread, 7.0)
    run.end(timer, thread, 7.1)
    text = plain(LanePainter().paint(told(run, until=10.0), *last(10, 10.0), 80, 8).rows)
    assert "A exclusive │     ──── kept by tick_callback ───·              │ free" in text


def test_the_same_in_ascii_has_no_other_glyph() -> None:
    timeline = shared_group(12.9)
    assert plain(LanePainter(Charset.ASCII).paint(timeline, *last(10, 12.9), 80, 8).rows) == drawn(
        """
        |MainThread  ||||||A timer_callback ###########################||  90% busy      |
        |A exclusive |.....-- held by timer_callback on MainThread -----| held, 2 wait   |
        |  odom      ||||||// waits 8.9 s: A held by timer_callback ****| 10/10! lost 168|
        |  scan      ||||||// waits 8.9 s: A held by timer_callback ****| 10/10! lost 168|
        |  timer     || |  -- runs 8.9 s on MainThread -----------------| late 8.4 s     |
        |seconds     |     4         6         8         10         now^| 200 ms/col     |
        """
    )


def test_a_call_is_marked_with_the_key_that_makes_such_calls() -> None:
    timeline = dummy_server(9.0)
    for service, mark in (("/dummy_server_srv", "▲s"), ("/another", "▲")):
        text = plain(LanePainter(service=service).paint(timeline, *last(10, 9.0), 80, 12).rows)
        assert mark in text
        assert ("▲s" in text) is (mark == "▲s")


def test_split_groups_fit_nine_rows_of_a_small_terminal() -> None:
    timeline = split_groups(9.412)
    assert plain(LanePainter(service="/motor_power").paint(timeline, *last(10, 9.412), 80, 9).rows) == drawn(
        """
        |Pool-0_0    │    ▎  ▎ ▎  ▎ ▎  ▎ ▎  A timer_callback ██████████▎│  55% busy      |
        |Pool-0_1    │  ▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎│   1% busy      |
        |Pool-0_2    │  ▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎│   1% busy      |
        |Pool-0_3    │                                                  │   0% unused    |
        |A excl timer│    ▎  ▎ ▎  ▎ ▎  ▎ ▎  ── runs 5.4 s on Pool-0_0 ──│ late 4.9 s     |
        |B excl odom │  ▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎│ queue 0/10     |
        |C excl scan │  ▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎▎│ queue 0/10     |
        |/motor_power│                                     ▲s◂          │ 1 call, 0.8 ms |
        |seconds     │  0         2         4         6         8   now▲│ 200 ms/col     |
        """
    )


def test_a_reentrant_group_shows_how_many_run_at_once() -> None:
    timeline = dummy_server(8.2)
    assert plain(LanePainter().paint(timeline, *last(10, 8.2), 80, 8).rows) == drawn(
        """
        |Pool-0_0    │              ▎    ▎ ▕A service_callback █████▊  ▎│  50% busy      |
        |Pool-0_1    │                        ▎    ▎    ▎    ▎    ▎     │   0% busy      |
        |A reentrant │              ·    · ── 2 at once ═────═────═──  ·│ open           |
        |  dummy_ser…│                     ▲s──── runs 5.0 s ───────◂   │ 1 call, 5.0 s  |
        |  timer     │              ▎    ▎    ▎    ▎    ▎    ▎    ▎    ▎│ on time        |
        |seconds     │         0         2         4         6      now▲│ 200 ms/col     |
        """
    )


def test_an_open_group_tells_how_many_run_and_wait() -> None:
    timeline = dummy_server_one_thread(6.0)
    assert "│ 1 runs, 1 waits" in plain(LanePainter().paint(timeline, *last(10, 6.0), 80, 8).rows)


def test_a_timer_that_found_no_worker_is_marked_late() -> None:
    timeline = dummy_server_one_thread(8.2)
    assert plain(LanePainter().paint(timeline, *last(10, 8.2), 80, 8).rows).splitlines()[3] == drawn(
        "|  timer     │              ▎    ▎    ╲╲ no free worker ╲╲╲╲▎! ▎│ on time        |"
    )


@pytest.mark.parametrize(("until", "status"), [(3.0, "on time"), (7.5, "last 5.5 s ago")])
def test_a_timer_that_comes_no_more_though_nothing_keeps_it_is_not_on_time(until: float, status: str) -> None:
    run = Run()
    tick = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    for at in (1.0, 2.0):
        run.callback(tick, run.thread("MainThread"), at, 0.01)
    assert f"│ {status} " in plain(LanePainter().paint(told(run, until=until), *last(10, until), 80, 8).rows)


@pytest.mark.parametrize(("until", "status"), [(1.3, "cancelled"), (1.6, "on time"), (7.5, "last 6.5 s ago")])
def test_a_timer_is_cancelled_until_it_is_reset(until: float, status: str) -> None:
    run = Run()
    tick = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.callback(tick, run.thread("MainThread"), 1.0, 0.01)
    run.add(TimerCancelled(ns(1.005), tick))
    run.add(TimerReset(ns(1.5), tick))
    assert f"│ {status} " in plain(LanePainter().paint(told(run, until=until), *last(10, until), 80, 8).rows)


@pytest.mark.parametrize("start", [4.0 + place / 50 for place in range(10)])
def test_a_timer_that_has_just_begun_tells_how_late_whatever_fills_its_column(start: float) -> None:
    window = Window(ns(start), ns(start + 10.0))
    timer = plain(LanePainter().paint(shared_group(), window, ns(14.0), 80, 8).rows).splitlines()[4]
    assert timer.endswith("was late 9.5 s ")


def test_a_wide_picture_names_threads_as_rclpy_does_and_tells_more() -> None:
    picture = plain(LanePainter().paint(split_groups(9.412), *last(10, 9.412), 138, 9).rows)
    assert "ThreadPoolExecutor-0_0 │" in picture
    assert "  0%  not used yet" in picture
    assert "A timer 5.4 s" in picture
    assert "queue 0/10 · age 1.0 ms" in picture


@settings(max_examples=examples(60), deadline=None)
@given(
    st.sampled_from(RUNS).map(lambda timeline: timeline()),
    st.integers(-ns(5), ns(40)),
    st.integers(1, ns(60)),
    st.integers(0, ns(40)),
    st.integers(1, 160),
    st.integers(0, 14),
    st.sampled_from(Charset),
)
def test_every_picture_has_the_size_that_was_asked_for(
    timeline: Timeline, start: int, length: int, now: int, width: int, height: int, charset: Charset
) -> None:
    picture = LanePainter(charset).paint(timeline, Window(start, start + length), now, width, height)
    assert len(picture.rows) <= height
    assert all(cell_len("".join(run.text for run in row)) == width for row in picture.rows)
    assert charset is not Charset.ASCII or plain(picture.rows).isascii()


@settings(max_examples=examples(20), deadline=None)
@given(st.lists(st.integers(0, ns(30)), min_size=1, max_size=6), st.sampled_from([ns(0.5), ns(10), ns(60)]))
def test_a_painter_paints_the_same_whatever_it_painted_before(moments: list[int], length: int) -> None:
    timeline = shared_group()
    used = LanePainter()
    for now in moments:
        window = Window(now - length, now)
        assert used.paint(timeline, window, now, 100, 8) == LanePainter().paint(timeline, window, now, 100, 8)


def test_lanes_that_fill_frame_by_frame_end_as_if_painted_at_once() -> None:
    timeline = shared_group()
    window, now = Window(0, ns(30)), ns(29)
    at_once = LanePainter().paint(timeline, window, now, 100, 14)
    painter = LanePainter(looks=300)
    pictures = [painter.paint(timeline, window, now, 100, 14) for _ in range(60)]
    assert not pictures[0].complete
    assert "·" in plain(pictures[0].rows) or plain(pictures[0].rows) != plain(at_once.rows)
    assert pictures[-1] == at_once


def test_lanes_that_grow_look_as_if_painted_at_once() -> None:
    events = shared_group_run().events
    growing, painter = Timeline(), LanePainter()
    done = 0
    for now in (2.0, 4.6, 5.0, 13.9, 14.3, 24.1, 26.0):
        upto = next((place for place, event in enumerate(events) if event.t > ns(now)), len(events))
        growing.extend(events[done:upto])
        done = upto
        assert plain(painter.paint(growing, *last(10, now), 100, 8).rows) == plain(
            LanePainter().paint(growing, *last(10, now), 100, 8).rows
        )


def test_at_the_highest_speed_each_picture_of_a_lesson_is_complete() -> None:
    events = shared_group_run().events
    growing, painter = Timeline(), LanePainter(looks=INTERVALS_PER_FRAME)
    for frame in range(1, 18):
        now = frame * ns(20 / 12)
        since = now - ns(20 / 12) if frame > 1 else -1
        growing.extend([event for event in events if since < event.t <= now])
        assert painter.paint(growing, Window(now - ns(10), now), now, 80, 8).complete


def test_a_callbacks_name_never_reaches_the_terminal_as_a_control() -> None:
    run = Run()
    thread = run.thread("Main\x1b[31mThread")
    timer = run.timer(run.exclusive(run.node("/n")), "evil\x1b]0;title\x07" * 9, 1.0)
    run.callback(timer, thread, 1.0, 8.0)
    run.stop(10.0)
    picture = plain(LanePainter().paint(told(run), *last(10, 10.0), 80, 6).rows)
    assert "\x1b" not in picture
    assert "\x07" not in picture
    assert "Main␛[31mTh…" in picture


def test_a_failed_call_is_crossed() -> None:
    run, thread, a, _ = small_run()
    run.start(a, thread, 1.0)
    run.fail(a, thread, 3.0, "IndexError: 720")
    run.end(a, thread, 3.0)
    run.stop(10.0)
    assert "✗" in plain(LanePainter().paint(told(run), *last(10, 10.0), 80, 6).rows).splitlines()[0]


@pytest.mark.parametrize(
    ("reason", "words"),
    [
        (Reason.GROUP_HELD, "╱╱ waits 5.0 s of 19.0 s: group A held by tick_callback ╱"),
        (Reason.NO_FREE_WORKER, "╲╲ waits 5.0 s of 19.0 s: no free worker ╲"),
        (Reason.EVENT_QUEUE, "≡≡ waits 5.0 s of 19.0 s: behind others in the event queue ≡"),
        (Reason.NOBODY_SPINS, "╳╳ waits 5.0 s of 19.0 s: nobody spins ╳"),
    ],
)
def test_each_reason_has_its_texture_and_its_words(reason: Reason, words: str) -> None:
    run, thread, a, tick = small_run()
    run.callback(tick, thread, 1.0, 19.0)
    run.wait(a, 1.0, 20.0, reason, tick if reason is Reason.GROUP_HELD else 0)
    run.stop(20.0)
    assert words in plain(LanePainter().paint(told(run), Window(0, ns(6)), ns(6), 140, 6).rows)


def test_a_wait_is_told_as_of_the_cursor() -> None:
    timeline = shared_group()
    before = plain(LanePainter().paint(timeline, Window(0, ns(30)), ns(10), 140, 7).rows)
    after = plain(LanePainter().paint(timeline, Window(0, ns(30)), ns(26), 140, 7).rows)
    assert "waits 6.0 s of 20.0 s: A held by timer_callback" in before
    assert "waited 20.0 s: group A held by timer_callback" in after


def test_a_wait_that_begins_at_the_cursor_has_no_length_yet() -> None:
    timeline = shared_group()
    (wait, *_) = timeline.waits_of(next(iter(timeline.moment(ns(10)).waiting)), Window(ns(10), ns(11)))
    at_first = plain(LanePainter().paint(timeline, Window(0, ns(30)), wait.start, 140, 7).rows)
    assert "waits 0 s" not in at_first
    assert " group A held by timer_callback " in at_first


def test_what_lies_after_the_cursor_is_drawn_later_in_ink() -> None:
    picture = LanePainter().paint(shared_group(), Window(0, ns(30)), ns(10), 140, 7)
    bars = [run for run in picture.rows[0] if run.ink.role is Role.BAR]
    assert [run.ink.later for run in bars] == sorted(run.ink.later for run in bars)
    assert {run.ink.later for run in bars} == {False, True}


def test_a_call_after_the_cursor_has_no_length_yet() -> None:
    run = Run()
    node = run.node("/node")
    group = run.exclusive(node)
    timer = run.timer(group, "tick", 1.0)
    run.timer(group, "other", 1.0)
    run.start(timer, run.thread("MainThread"), 4.0)
    run.printed("still at it", 9.0)
    picture = plain(LanePainter().paint(told(run), Window(0, ns(10)), ns(2), 140, 7).rows)
    assert " runs on MainThread " in picture


def test_a_short_window_still_shows_the_last_call_that_reaches_into_it() -> None:
    picture = plain(LanePainter().paint(shared_group(), Window(ns(9), ns(9.001)), ns(9.001), 80, 7).rows)
    assert "A timer_callback ███" in picture
    assert "waits 5.0 s" in picture


def test_a_group_of_one_shares_its_lane_with_its_callback() -> None:
    lanes = LanePainter().paint(split_groups(), *last(10, 10), 80, 20).lanes
    assert [type(lane) for lane in lanes] == [ThreadLane] * 4 + [SoleLane] * 3 + [ServiceLane]


def test_a_call_without_a_reply_says_since_when() -> None:
    timeline = dummy_server(5.05)
    assert "no reply 2.5 s" in plain(LanePainter().paint(timeline, *last(10, 5.05), 80, 8).rows)


def test_the_services_that_every_node_brings_along_have_no_lanes() -> None:
    run, _, _, _ = small_run()
    run.service(run.exclusive(run.node("/m")), "/m/get_parameters", "")
    assert "get_parameters" not in plain(LanePainter().paint(told(run), *last(10, 10), 80, 20).rows)


POOL = ("ThreadPoolExecutor-0_0", "ThreadPoolExecutor-0_1")


def test_a_main_thread_that_only_hands_out_work_has_no_lane() -> None:
    run = Run()
    run.thread("MainThread")
    worker = run.thread("ThreadPoolExecutor-0_0")
    run.callback(run.timer(run.exclusive(run.node("/n")), "tick_callback", 1.0), worker, 1.0, 1.0)
    assert "MainThread" not in plain(LanePainter().paint(told(run), *last(10, 10), 80, 20).rows)


def test_a_thread_was_never_needed_once_the_run_is_over() -> None:
    run = Run()
    first, second = (run.thread(name) for name in POOL)
    timer = run.timer(run.exclusive(run.node("/n")), "tick_callback", 1.0)
    run.callback(timer, first, 1.0, 1.0)
    run.callback(timer, second, 3.0, 1.0)
    run.over(5.0, "its time was up", failed=False)
    shown = plain(LanePainter().paint(told(run), *last(10, 2.5), 120, 20).rows)
    assert [word in shown for word in ("never needed", "not used yet")] == [False, True]
    narrow = plain(LanePainter().paint(told(run), *last(10, 2.5), 80, 20).rows)
    assert [word in narrow for word in ("unused", "0% not yet")] == [False, True]


def test_a_thread_of_the_programs_own_is_not_said_to_be_unneeded() -> None:
    run = Run()
    own, worker, _ = (run.thread(name) for name in ("beeper", *POOL))
    timer = run.timer(run.exclusive(run.node("/n")), "tick_callback", 1.0)
    run.callback(timer, worker, 1.0, 1.0)
    run.log("beep", 2.0, own)
    shown = plain(LanePainter().paint(told(run), *last(10, 10), 120, 20).rows).splitlines()
    (beeper,) = (line for line in shown if "beeper" in line)
    (unused,) = (line for line in shown if POOL[1] in line)
    assert "not used yet" in unused
    assert "not used yet" not in beeper
    assert "0%" not in beeper
    assert "no callbacks" in beeper


def test_where_room_is_short_those_who_wait_and_run_stay() -> None:
    timeline = shared_group(12.9)
    picture = LanePainter().paint(timeline, *last(10, 12.9), 80, 4)
    assert [type(lane) for lane in picture.lanes] == [ThreadLane, GroupLane, MemberLane]
    assert plain(picture.rows).splitlines()[-1].startswith("+2 lanes")


def test_the_rows_wanted_are_the_rows_painted() -> None:
    for timeline in (each() for each in RUNS):
        wanted = wanted_rows(timeline, "/motor_power")
        assert len(LanePainter(service="/motor_power").paint(timeline, *last(10, 10), 80, 50).rows) == wanted


def test_a_millisecond_and_ten_minutes_fill_a_screen() -> None:
    timeline = shared_group()
    near = plain(LanePainter().paint(timeline, Window(ns(4.0025), ns(4.0035)), ns(4.0035), 80, 7).rows)
    assert near == drawn(
        """
        |MainThread  │A timer_callback █████████████████████████████████│ 100% busy      |
        |A exclusive │── held by timer_callback on MainThread ──────────│ held, 1 waits  |
        |  odom      │                         ╱╱ A held by timer ╱╱╱╱╱╱│ queue 1/10     |
        |  scan      │                                                 ┊│ queue 0/10     |
        |  timer     │── runs 3.5 ms of 10.0 s on MainThread ───────────│ on time        |
        |seconds     │     4.0026    4.0028    4.0030    4.0032  cursor▲│ 20 µs/col      |
        """
    )
    far = plain(LanePainter().paint(timeline, Window(0, ns(600)), ns(30), 80, 7).rows)
    assert "12.0 s/col" in far


def test_a_lane_without_calls_is_not_painted_again_as_the_run_goes_on() -> None:
    events, timeline, painter = split_groups_run().events, Timeline(), LanePainter()
    kept = []
    for first, second in ((0, 9), (9, 12)):
        timeline.extend([event for event in events if ns(first) < event.t + 1 <= ns(second)])
        painter.paint(timeline, *last(10, second), 80, 20)
        lane = ThreadLane([*timeline.threads.values()][-1])
        kept.append(painter.cache.painted[lane][1])
    assert kept[0] is kept[1]
