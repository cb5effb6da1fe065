"""The summary of a run: its figures, and how they read."""

import pytest

from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import name_of
from sim.trace.events import Published, Reason, RunEnded
from sim.trace.figures.summary import Summary, robot_incrementally, summarise
from sim.trace.figures.summary_text import NOT_KNOWN, plain_text
from sim.trace.incremental import run_to_end
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.runs import Run, dummy_server_one_thread_run, ns, shared_group_run, split_groups_run

SHARED_GROUP = """\
shared-group, 30.0 s of virtual time: its time was up

callback        group  calls  running  late by  lost  errors
odom_callback   A        209     0.3%   498 ms   390       0
scan_callback   A        209     0.3%   495 ms   390       0
timer_callback  A         21    66.7%    9.5 s     -       0
late by: its oldest message, taken or waiting, or how late its timer was

longest waits
  odom_callback   20.0 s: group A held by timer_callback
  scan_callback   20.0 s: group A held by timer_callback
  timer_callback  9.5 s: group A held by timer_callback

threads  1 ran callbacks, at most 1 at once
robot    1 turn (4.0 rad), 0.76 m travelled, at x -0.03 y 0.36 heading 131°
"""

ONE_THREAD = """\
reentrant-1-thread, 10.0 s of virtual time: its time was up

callback          group  calls  running  late by  lost  errors
service_callback  A          1    50.0%      0 s     0       0
timer_callback    A          6     0.1%    4.5 s     -       0
late by: its oldest message, taken or waiting, or how late its timer was

longest waits
  timer_callback  4.5 s: no free worker

threads  1 ran callbacks, at most 1 at once
calls    /dummy_server_srv  1 call, answered after 5.0 s
robot    1 turn (1.0 rad), 0.00 m travelled, at x 0.00 y 0.00 heading 57°
"""


def summary_of(run: Run) -> Summary:
    timeline = Timeline()
    timeline.extend(run.events)
    return summarise(timeline)


def small_run() -> tuple[Run, int, int, int]:
    """A run of a thread, a timer and a subscription, with their ids."""
    run = Run("small")
    thread = run.thread("MainThread")
    group = run.exclusive(run.node("/node"))
    timer = run.timer(group, "timer_callback", 1.0)
    return run, thread, timer, run.subscription(group, "/odom", "odom_callback")


@pytest.mark.parametrize(
    ("run", "text"), [(shared_group_run(), SHARED_GROUP), (dummy_server_one_thread_run(), ONE_THREAD)]
)
def test_golden_summaries(run: Run, text: str) -> None:
    assert plain_text(summary_of(run)) == text


@pytest.mark.parametrize("run", [shared_group_run(), split_groups_run(), dummy_server_one_thread_run()])
def test_a_summary_fits_the_smallest_terminal(run: Run) -> None:
    assert max(map(len, plain_text(summary_of(run)).splitlines())) <= 79


def test_a_run_without_robot_and_calls_does_not_speak_of_them() -> None:
    run, thread, timer, _ = small_run()
    run.callback(timer, thread, 1.0, 0.5)
    text = plain_text(summary_of(run))
    assert "robot" not in text
    assert "calls  " not in text.split("longest waits")[1]


@pytest.mark.parametrize(("count", "rows"), [(4, ["halt (/node)"] * 4), (5, ["halt (/node) × 5"])])
def test_many_timers_of_one_function_and_period_have_one_row(count: int, rows: list[str]) -> None:
    run = Run("small")
    thread = run.thread("MainThread")
    group = run.exclusive(run.node("/node"))
    for number in range(count):
        run.callback(run.timer(group, "halt", 1.0), thread, 1.0 + number, 0.5)
    run.timer(group, "halt", 2.0)
    table = plain_text(summary_of(run)).split("\n\n")[1].splitlines()[1:-1]
    assert [each.split("  ")[0] for each in table] == [*rows, "halt (/node)"]
    assert sum(int(each.split(" A ")[1].split()[0]) for each in table) == count


def test_an_empty_timeline_has_a_summary() -> None:
    assert plain_text(summarise(Timeline())) == "run, 0 s\n\nthreads  0 ran callbacks, at most 0 at once\n"


@pytest.mark.parametrize(("time_was_up", "told"), [(True, 1), (False, 0)])
def test_that_the_time_was_up_before_there_was_a_node_is_told(time_was_up: bool, told: int) -> None:
    timeline = Timeline()
    timeline.extend([RunEnded(SECOND, "its end", failed=False, time_was_up=time_was_up)])
    assert (
        plain_text(summarise(timeline)).count("nodes    none was made by then: let it run for longer") == told
    )


def test_the_servers_of_an_action_in_two_nodes_are_told_apart_by_these() -> None:
    run = Run("small")
    thread = run.thread("MainThread")
    for node in ("/robot", "/dispatcher"):
        run.callback(
            run.subscription(run.exclusive(run.node(node)), "/fetch_it server", ""), thread, 1.0, 0.0
        )
    names = [callback.name for callback in summary_of(run).callbacks]
    assert names == ["/fetch_it server (/robot)", "/fetch_it server (/dispatcher)"]


def test_where_nobody_waited_the_summary_says_so() -> None:
    run, thread, timer, _ = small_run()
    run.callback(timer, thread, 1.0, 0.5)
    assert "longest waits: none, every callback ran as soon as it was ready\n" in plain_text(summary_of(run))


def test_a_wait_that_would_be_told_as_none_is_none() -> None:
    run, thread, timer, odom = small_run()
    run.callback(timer, thread, 1.0, 0.5)
    run.wait(odom, 1.0, 1.000_000_400, Reason.NO_FREE_WORKER)
    run.robot(3.0)
    assert "longest waits: none" in plain_text(summary_of(run))


def test_a_callback_that_was_late_without_a_known_wait_did_not_run_as_soon_as_it_was_ready() -> None:
    run, thread, timer, _ = small_run()
    run.callback(timer, thread, 1.3, 0.5, late=0.3)
    assert "longest waits: none for a group or a thread\n" in plain_text(summary_of(run))


def test_waits_of_one_series_count_as_one_with_the_reason_of_most_of_it() -> None:
    run, _, timer, odom = small_run()
    run.wait_changes(odom, 1.0, 1.0, Reason.NO_FREE_WORKER)
    run.wait_changes(odom, 2.0, 1.0, Reason.GROUP_HELD, holder=timer)
    run.wait_changes(odom, 5.0, 1.0, Reason.NO_FREE_WORKER)
    run.robot(6.5)
    wait = summary_of(run).callbacks[1].longest_wait
    assert wait is not None
    assert (wait.length, wait.why) == (ns(5.5), "group A held by timer_callback")


def test_the_longest_of_several_waits_is_told() -> None:
    run, _, timer, odom = small_run()
    run.wait(odom, 1.0, 2.0, Reason.NOBODY_SPINS)
    run.wait(odom, 3.0, 7.0, Reason.GROUP_HELD, holder=timer)
    run.wait(odom, 8.0, 9.0, Reason.NO_FREE_WORKER)
    wait = summary_of(run).callbacks[1].longest_wait
    assert wait is not None
    assert wait.length == ns(4.0)


def test_what_still_waits_at_the_end_is_as_late_as_it_has_waited() -> None:
    run, thread, timer, odom = small_run()
    run.callback(timer, thread, 1.0, 0.1, late=0.2)
    run.wait(timer, 2.0, None, Reason.NO_FREE_WORKER)
    run.wait(odom, 3.0, None, Reason.NO_FREE_WORKER)
    run.robot(6.5)
    assert [each.late for each in summary_of(run).callbacks] == [ns(4.5), ns(3.5)]
    row = plain_text(summary_of(run)).splitlines()[3]
    assert row.split() == ["timer_callback", "A", "1", "1.5%", "4.5", "s", "-", "0"]


def test_calls_after_calls_that_take_no_time_are_not_at_once() -> None:
    run, thread, timer, odom = small_run()
    other = run.thread("other")
    run.callback(timer, thread, 1.0, 0.0)
    run.callback(odom, other, 1.0, 0.0)
    summary = summary_of(run)
    assert (summary.threads_used, summary.threads_at_once) == (2, 1)


def test_nested_calls_of_one_thread_are_one_thread_at_once() -> None:
    run, thread, timer, odom = small_run()
    run.callback(timer, thread, 1.0, 2.0)
    run.callback(odom, thread, 1.5, 0.5)
    assert summary_of(run).threads_at_once == 1


def test_a_call_that_was_suspended_is_one_call_with_one_error() -> None:
    run, thread, _, odom = small_run()
    run.start(odom, thread, 1.0)
    run.suspend(odom, thread, 2.0)
    run.resume(odom, thread, 4.0)
    run.fail(odom, thread, 5.0, "IndexError: no beam")
    figures = summary_of(run).callbacks[1]
    assert (figures.calls, figures.errors, figures.running) == (1, 1, 2.0 / 5.0)


def test_callbacks_of_one_name_are_told_apart_by_their_topics() -> None:
    run, _, _, _ = small_run()
    run.subscription(1, "/scan", "odom_callback")
    names = [figures.name for figures in summary_of(run).callbacks]
    assert names == ["timer_callback", "odom_callback (/odom)", "odom_callback (/scan)"]


@pytest.mark.parametrize(
    ("function", "told"),
    [
        ("press", ["press (/press, line 18)", "press (/press, line 19)"]),
        ("<lambda>", ["<lambda>:18", "<lambda>:19"]),
    ],
)
def test_callbacks_of_one_name_in_one_node_are_told_apart_by_their_lines(
    function: str, told: list[str]
) -> None:
    run = Run()
    group = run.exclusive(run.node("/press"))
    timers = [run.timer(group, function, 1.0, lines=(line, line)) for line in (18, 19)]
    timeline = Timeline()
    timeline.extend(run.events)
    assert [each.name for each in summarise(timeline).callbacks] == told
    assert name_of(timers[1], timeline) == (told[1] if function == "<lambda>" else function)


def test_service_calls_tell_how_many_were_answered_and_how_soon() -> None:
    run, _, _, _ = small_run()
    run.call("/a", 1.0, replied=1.5)
    run.call("/a", 2.0, replied=4.0)
    run.call("/a", 3.0)
    run.call("/b", 3.0)
    text = plain_text(summary_of(run))
    assert "calls    /a  3 calls, 2 answered after 500 ms to 2.0 s\n" in text
    assert "         /b  1 call, no reply\n" in text


@pytest.mark.parametrize(
    ("rates", "turns", "turned"),
    [
        ((0.0,) + (0.2,) * 10 + (0.0,), 1, 2.0),
        ((0.2,) * 5 + (0.0,) + (0.2,) * 5, 2, 2.0),
        ((0.2,) * 5 + (-0.2,) * 5, 1, 0.0),
        ((0.0,) * 10, 0, 0.0),
    ],
    ids=["one", "two with a rest", "there and back", "none"],
)
def test_a_turn_goes_from_a_command_to_turn_to_the_first_one_not_to(
    rates: tuple[float, ...], turns: int, turned: float
) -> None:
    run, _, _, _ = small_run()
    for second, rate in enumerate(rates):
        run.robot(float(second), turned=sum(rates[:second]))
        run.velocity(float(second), 0.1, rate)
    run.robot(float(len(rates)), turned=sum(rates))
    robot = summary_of(run).robot
    assert robot is not None
    assert (robot.turns, round(robot.turned, 9)) == (turns, turned)


def test_two_turns_right_after_each_other_are_two_also_in_a_window_that_begins_in_the_first() -> None:
    run, _, _, _ = small_run()
    for at, rate in ((1.0, 0.2), (3.0, 0.0), (3.0, 0.2), (4.0, 0.0)):
        run.velocity(at, 0.0, rate)
    for second in range(1, 6):
        run.robot(float(second), turned=0.2 * min(3, max(0, second - 1)))
    timeline = Timeline()
    timeline.extend(run.until(5.0))
    robot = run_to_end(robot_incrementally(timeline, Window(ns(2.0), ns(5.0))))
    assert robot is not None
    assert (robot.turns, round(robot.turned, 9)) == (2, 0.4)


def test_a_turn_that_begins_before_the_first_pose_counts_from_a_robot_at_rest() -> None:
    run, _, _, _ = small_run()
    run.velocity(0.0, 0.0, 0.2)
    run.robot(1.0, turned=0.2)
    run.robot(5.0, turned=1.0)
    robot = summary_of(run).robot
    assert robot is not None
    assert (robot.turns, robot.turned) == (1, 1.0)


def test_a_pose_is_never_minus_zero() -> None:
    run, _, _, _ = small_run()
    run.robot(1.0, x=-0.001, y=-0.0, yaw=-0.001)
    assert plain_text(summary_of(run)).endswith("at x 0.00 y 0.00 heading 0°\n")


def test_lost_events_are_admitted() -> None:
    run, _, _, _ = small_run()
    run.lost(12, 1.0)
    assert "The trace lost 12 events, so some figures below are too small.\n" in plain_text(summary_of(run))


@pytest.mark.parametrize(
    ("missing", "clock", "lost"), [(0, "real", "0"), (2, "real", "-"), (2, "virtual", "0")]
)
def test_losses_on_real_ros_2_are_not_known_where_messages_came_nowhere(
    missing: int, clock: str, lost: str
) -> None:
    run = Run("small", clock)
    thread = run.thread("MainThread")
    odom = run.subscription(run.exclusive(run.node("/node")), "/odom", "odom_callback")
    for each in range(missing):
        run.add(Published(each, 100 + each, "/odom", 0, 0))
    run.message(odom, 1.0)
    run.callback(odom, thread, 1.0, 0.1)
    run.message(odom, 1.5)
    _, row, *rest = plain_text(summary_of(run)).split("\n\n")[1].splitlines()
    assert row.split()[-2:] == [lost, "0"]
    assert (NOT_KNOWN in rest) == (lost == "-")
