"""The course's own files, run as they are printed, do what the course says of them."""

from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import pytest

from sim.engine.setup import ProgramSetup, RobotUse, RunSetup, TimedCall, TimedLine
from sim.trace.events import (
    LineEnded,
    LineSaid,
    Logged,
    MessageDropped,
    Printed,
    ProcessAppeared,
    RobotMoved,
    VelocityCommanded,
)
from tests.course.cutting import PACKAGE, VARIABLE, course_text, make_package, shell_line
from tests.support.builder import ns
from tests.support.engine_runs import Run, run_to_end

_TEXT = course_text()
pytestmark = pytest.mark.skipif(_TEXT is None, reason=f"{VARIABLE} does not say where the course's text is")

ONE_AT_A_TIME = ("exercise51", "exercise52")
SLEEPING = [f"SLEEPING=={second} seconds" for second in range(10)]
SENSORS = ["Odom CallBack", "Scan CallBack"]
CALL = "ros2 service call /dummy_server_srv std_srvs/srv/SetBool data:\\ false"


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The root of the course's package."""
    assert _TEXT is not None
    return make_package(_TEXT, tmp_path_factory.mktemp("src"))


@lru_cache
def run_robot(package: Path, name: str) -> Run:
    """A minute of one of the files that drive the robot."""
    path = package / PACKAGE / f"{name}.py"
    return run_to_end(
        RunSetup(
            title=name,
            programs=(ProgramSetup(str(path)),),
            speed=None,
            until=ns(60),
            robot=RobotUse.ALWAYS,
        )
    )


def run_server(package: Path, group: str, threads: int, seconds: float, *calls: float) -> Run:
    """``callback_groups_examples`` with the course's options, its service called at the times given."""
    path = package / PACKAGE / "callback_groups_examples.py"
    return run_to_end(
        RunSetup(
            title=path.name,
            programs=(ProgramSetup(str(path), tuple(options(group, threads).split())),),
            speed=None,
            until=ns(seconds),
            calls=tuple(TimedCall(ns(at), data=False) for at in calls),
            robot=RobotUse.WHEN_USED,
        )
    )


def run_lines(package: Path, seconds: float, *lines: tuple[float, str]) -> Run:
    """A run that is given nothing but ``ros2`` lines and the folder where the package lies."""
    return run_to_end(
        RunSetup(
            title="lines",
            programs=(),
            speed=None,
            until=ns(seconds),
            lines=tuple(TimedLine(ns(at), text) for at, text in lines),
            packages=(str(package.parent),),
            robot=RobotUse.WHEN_USED,
        )
    )


def options(group: str, threads: int) -> str:
    return f"-service_wait_time 5.0 -timer_period 1.0 -callback_group_type {group} -threads {threads}"


def texts(run: Run) -> list[str]:
    return [text for _, text in run.logs()]


def rotations(run: Run) -> list[float]:
    """When the robot began to rotate."""
    return [at for at, text in run.logs() if text == "STOP ROTATE"]


def ticks(run: Run) -> list[float]:
    return [at for at, text in run.logs() if text in {"TICK", "TACK"}]


def front(line: str) -> float:
    """What the sensor showed, as the timer's callback says it."""
    return float(line.rpartition(">RANGES Value=")[2])


@pytest.mark.parametrize("name", ONE_AT_A_TIME)
def test_with_one_thread_no_sensor_callback_runs_while_the_robot_rotates(package: Path, name: str) -> None:
    run = run_robot(package, name)
    lines = texts(run)
    first = lines.index(SLEEPING[0])
    assert lines[first : first + 10] == SLEEPING
    for begin in rotations(run):
        for callback in ("odom_callback", "scan_callback"):
            assert not [at for at in run.starts(callback) if begin < at < begin + 10]


@pytest.mark.parametrize("name", ONE_AT_A_TIME)
def test_with_one_thread_the_robot_rotates_twice_since_the_timer_comes_first_with_the_old_value(
    package: Path, name: str
) -> None:
    lines = texts(run_robot(package, name))
    assert lines.count("STOP ROTATE") == 2
    stale = lines[lines.index("STOP ROTATE") - 1]
    assert front(stale) < 0.5
    first, second = (place for place, line in enumerate(lines) if line == SLEEPING[-1])
    assert lines[first + 1 : first + 5] == ["Timer CallBack", stale, "STOP ROTATE", "Rotating for 10 seconds"]
    after = lines[second + 1 : second + 6]
    assert after[:3] == [*SENSORS, "Timer CallBack"]
    assert front(after[3]) > 5.0
    assert after[4] == "MOVE STRAIGHT"


@pytest.mark.parametrize("name", [*ONE_AT_A_TIME, "exercise53"])
def test_before_the_sphere_odom_and_scan_take_turns(package: Path, name: str) -> None:
    lines = texts(run_robot(package, name))
    sensors = [line for line in lines[: lines.index("STOP ROTATE")] if line in SENSORS]
    assert sensors[:2] == SENSORS
    assert len(sensors) > 100
    assert all(before != after for before, after in pairwise(sensors))


def test_an_explicit_executor_and_group_change_nothing(package: Path) -> None:
    plain, explicit = (run_robot(package, name) for name in ONE_AT_A_TIME)
    assert [(at, text.replace("||||", "")) for at, text in explicit.logs()] == plain.logs()


def test_with_three_groups_and_four_threads_the_sensors_go_on_while_the_robot_rotates_once(
    package: Path,
) -> None:
    run = run_robot(package, "exercise53")
    (begin,) = rotations(run)
    for callback in ("odom_callback", "scan_callback"):
        starts = run.starts(callback)
        for second in range(10):
            assert [at for at in starts if begin + second < at < begin + second + 1]
    assert not [event for event in run.events if isinstance(event, MessageDropped)]
    lines = texts(run)
    after = lines.index("Timer CallBack", lines.index(SLEEPING[-1]))
    decision = [line for line in lines[after + 1 :] if line not in SENSORS][:2]
    assert front(decision[0]) > 5.0
    assert decision[1] == "MOVE STRAIGHT"


@pytest.mark.parametrize(
    ("group", "threads", "expected"),
    [
        ("exclusive", 2, [1, 2, 3, 4, 5, 6, 7, 8, 9]),
        ("reentrant", 2, [1, 2, 3, 4, 5, 6, 7, 8, 9]),
        ("reentrant", 1, [1, 2, 7.55, 8, 9]),
        ("exclusive", 1, [1, 2, 7.55, 8, 9]),
        ("none", 2, [1, 2, 7.55, 8, 9]),
    ],
)
def test_the_timer_ticks_beside_the_call_where_groups_and_threads_allow(
    package: Path, group: str, threads: int, expected: list[float]
) -> None:
    run = run_server(package, group, threads, 9.5, 2.55)
    assert ticks(run) == expected
    assert run.ending.reason == "its time was up"
    lines = texts(run)
    assert f"DummyServer Started with threads={threads}" in lines
    waiting = [f"...{second}[WAITING...]" for second in ("0", "1.0", "2.0", "3.0", "4.0")]
    serving = [line for line in lines if "WAITING" in line or "Processing" in line]
    assert serving == ["Processing Server Message...", *waiting, "Processing Server Message...DONE"]


@pytest.mark.parametrize(
    ("group", "late"), [("reentrant", [1, 2, 7.55, 8, 9, 10, 11]), ("exclusive", list(range(1, 12)))]
)
def test_three_calls_at_once_take_both_workers_of_a_reentrant_group_and_turns_in_an_exclusive_one(
    package: Path, group: str, late: list[float]
) -> None:
    assert ticks(run_server(package, group, 2, 11.5, 2.55, 2.55, 2.55)) == late


def test_the_options_that_the_course_gives_are_the_programs_and_wrong_ones_end_it(package: Path) -> None:
    path = package / PACKAGE / "callback_groups_examples.py"
    setup = RunSetup(title="x", programs=(ProgramSetup(str(path)),), speed=None, until=ns(2))
    run = run_to_end(setup)
    assert run.ending.reason == "the program ended with exit code 2 (callback_groups_examples.py:52)"
    printed = [event.text for event in run.events if isinstance(event, Printed)]
    assert printed[-1].endswith("error: the following arguments are required: -service_wait_time")


@pytest.mark.parametrize("group", ["exclusive", "reentrant"])
def test_the_courses_shell_lines_run_the_server_and_call_it(package: Path, group: str) -> None:
    command = f"ros2 run {PACKAGE} callback_groups_examples {options(group, 2)}"
    run = run_lines(package, 9.5, (0, command), (2.55, CALL))
    assert ticks(run) == [1, 2, 3, 4, 5, 6, 7, 8, 9]
    said = [event.text for event in run.events if isinstance(event, LineSaid) and event.line == 2]
    assert "requester: making request: std_srvs.srv.SetBool_Request(data=False)" in said
    assert "std_srvs.srv.SetBool_Response(success=False, message='TURNING')" in said
    (end,) = (event for event in run.events if isinstance(event, LineEnded) and event.line == 2)
    assert (end.t, end.status) == (ns(7.55), 0)


@pytest.mark.parametrize(("name", "turns"), [("exercise51", 2), ("exercise52", 2), ("exercise53", 1)])
def test_the_courses_launch_files_start_its_nodes(package: Path, name: str, turns: int) -> None:
    run = run_lines(package, 40, (0, f"ros2 launch {PACKAGE} {name}.launch.py"))
    (process,) = (event for event in run.events if isinstance(event, ProcessAppeared))
    assert process.label == f"{name}-1"
    assert {event.logger for event in run.events if isinstance(event, Logged)} == {"sub_node"}
    assert texts(run).count("STOP ROTATE") == turns


def test_the_courses_shell_lines_stop_the_robot_and_put_it_back(package: Path) -> None:
    assert _TEXT is not None
    stop = shell_line(_TEXT, "ros2 topic pub /cmd_vel")
    reset = shell_line(_TEXT, "ros2 service call /reset_world")
    assert len(stop.splitlines()) > 6
    launch = f"ros2 launch {PACKAGE} exercise51.launch.py"
    run = run_lines(package, 8, (0, launch), (3.2, stop), (6.3, reset))
    commands = [event for event in run.events if isinstance(event, VelocityCommanded)]
    assert {each.linear for each in commands if each.t < ns(3.2)} == {0.08}
    stops = [each.t / 1e9 for each in commands if (each.linear, each.angular) == (0, 0)]
    assert {3.2, 4.2, 5.2, 6.2, 7.2} <= set(stops)
    places = {event.t: (event.x, event.y) for event in run.events if isinstance(event, RobotMoved)}
    start, before, after = (
        next(place for t, place in places.items() if t >= ns(at)) for at in (0, 6.2, 6.35)
    )
    assert before != pytest.approx(start, abs=0.05)
    assert after == pytest.approx(start, abs=0.02)
