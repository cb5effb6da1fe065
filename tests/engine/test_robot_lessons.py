"""What the robot lessons must show: the course's own sequence of callbacks and log lines."""

from itertools import pairwise

import pytest

from sim.trace.events import AnyEvent, CallbackStarted, EntityAppeared, Logged, MessageDropped, RobotMoved
from sim.trace.figures.summary import summarise
from tests.support.daily import first_daily
from tests.support.engine_runs import SECOND, Run, run_lesson

BLOCKED = first_daily("shared-group", "single-thread")
ROBOT_LESSONS = [*BLOCKED, pytest.param("split-groups", marks=pytest.mark.slow)]
SLEEPING = [f"SLEEPING=={second} seconds" for second in range(10)]


def _lines(run: Run) -> list[str]:
    return [text for _, text in run.logs()]


def _rotations(run: Run) -> list[tuple[float, float]]:
    """When each rotation began and ended: its timer callback from STOP ROTATE to ten seconds later."""
    return [(at, at + 10.0) for at, text in run.logs() if text == "STOP ROTATE"]


@pytest.mark.parametrize("lesson", ROBOT_LESSONS)
def test_odom_and_scan_alternate_before_the_robot_meets_the_sphere(lesson: str) -> None:
    run = run_lesson(lesson, 60)
    until = _lines(run).index("STOP ROTATE")
    sensors = [text for text in _lines(run)[:until] if text in {"Odom CallBack", "Scan CallBack"}]
    assert len(sensors) > 100
    assert all(before != after for before, after in pairwise(sensors))
    assert sensors[0] == "Odom CallBack"


@pytest.mark.parametrize("lesson", ROBOT_LESSONS)
def test_the_robot_rotates_only_once_the_front_is_closer_than_half_a_metre(lesson: str) -> None:
    lines = _lines(run_lesson(lesson, 60))
    decisions = [
        (float(value.rpartition("=")[2]), decision)
        for value, decision in pairwise(lines)
        if value.startswith(">>>>>>>>>RANGES Value=")
    ]
    assert len(decisions) > 60
    for front, decision in decisions:
        assert decision == ("STOP ROTATE" if front < 0.5 else "MOVE STRAIGHT")


@pytest.mark.parametrize("lesson", BLOCKED)
def test_nothing_else_runs_while_the_timer_callback_sleeps(lesson: str) -> None:
    run = run_lesson(lesson, 60)
    lines = _lines(run)
    first = lines.index("SLEEPING==0 seconds")
    assert lines[first : first + 10] == SLEEPING
    for begin, end in _rotations(run):
        for callback in ("odom_callback", "scan_callback"):
            assert not [at for at in run.starts(callback) if begin < at < end]


@pytest.mark.parametrize("lesson", BLOCKED)
def test_the_robot_turns_twice_since_the_first_look_after_the_turn_is_a_stale_one(lesson: str) -> None:
    run = run_lesson(lesson, 60)
    lines = _lines(run)
    end_of_first = lines.index("SLEEPING==9 seconds")
    stale = lines[lines.index("STOP ROTATE") - 1]
    assert lines[end_of_first + 1 : end_of_first + 4] == ["Timer CallBack", stale, "STOP ROTATE"]
    end_of_second = lines.index("SLEEPING==9 seconds", end_of_first + 1)
    after = lines[end_of_second + 1 : end_of_second + 6]
    assert after[:3] == ["Odom CallBack", "Scan CallBack", "Timer CallBack"]
    assert float(after[3].rpartition("=")[2]) > 5.0
    assert after[4] == "MOVE STRAIGHT"
    assert lines.count("STOP ROTATE") == 2


def test_an_explicit_executor_and_group_change_nothing() -> None:
    assert run_lesson("shared-group", 60).logs() == run_lesson("single-thread", 60).logs()


def test_split_groups_keep_the_sensors_running_while_the_robot_rotates() -> None:
    run = run_lesson("split-groups", 60)
    [(begin, end)] = _rotations(run)
    for callback in ("odom_callback", "scan_callback"):
        assert len([at for at in run.starts(callback) if begin <= at <= end]) >= 190
    assert not [event for event in run.events if isinstance(event, MessageDropped)]


@pytest.mark.parametrize(
    ("lesson", "turns", "radians"), [("single-thread", 2, 4.0), ("split-groups", 1, 2.0)]
)
def test_the_robot_turns_as_far_as_its_node_sleeps(lesson: str, turns: int, radians: float) -> None:
    robot = summarise(run_lesson(lesson, 60).timeline).robot
    assert robot is not None
    assert robot.turns == turns
    assert robot.turned == pytest.approx(radians, rel=0.05)


@pytest.mark.parametrize("lesson", ROBOT_LESSONS)
def test_the_robot_meets_no_second_obstacle_within_a_minute(lesson: str) -> None:
    run = run_lesson(lesson, 60)
    turned_away = _rotations(run)[-1][1]
    later = [
        event for event in run.events if isinstance(event, RobotMoved) and event.t > turned_away * SECOND
    ]
    assert later
    assert min(event.front for event in later) > 0.5
    assert not any(event.touching for event in run.events if isinstance(event, RobotMoved))


def test_a_full_queue_loses_its_oldest_messages_and_says_so() -> None:
    run = run_lesson("shared-group", 60)
    timeline = run.timeline
    odom = next(each for each in timeline.entities.values() if each.callback == "odom_callback")
    queue = timeline.queue(odom.id, 12 * SECOND)
    assert queue.depth == 10
    assert queue.dropped == 150


def test_more_threads_do_not_help_callbacks_that_share_a_group() -> None:
    run = run_lesson("shared-group", 20, threads=4)
    begin, _ = _rotations(run)[0]
    assert not [at for at in run.starts("scan_callback") if begin < at < begin + 10]


def test_one_thread_is_too_few_for_three_groups() -> None:
    run = run_lesson("split-groups", 20, threads=1)
    begin, _ = _rotations(run)[0]
    assert not [at for at in run.starts("scan_callback") if begin < at < begin + 10]
    after = [
        _name(run, event)
        for event in run.events
        if isinstance(event, CallbackStarted) and _after(event, begin)
    ]
    assert after[:5] == ["odom_callback", "scan_callback", "timer_callback", "odom_callback", "scan_callback"]


def _after(event: AnyEvent, begin: float) -> bool:
    return event.t >= (begin + 10) * SECOND


def _name(run: Run, started: CallbackStarted) -> str:
    return next(
        e.callback for e in run.events if isinstance(e, EntityAppeared) and e.entity == started.entity
    )


def test_log_lines_name_the_callback_and_thread_that_wrote_them() -> None:
    run = run_lesson("split-groups", 60)
    timeline = run.timeline
    line = next(e for e in run.events if isinstance(e, Logged) and e.text == "SLEEPING==3 seconds")
    assert timeline.entities[line.entity].callback == "timer_callback"
    assert timeline.threads[line.thread].name.startswith("ThreadPoolExecutor-")
