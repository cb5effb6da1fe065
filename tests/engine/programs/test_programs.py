"""Several programs in one run: each has what a process of its own would have."""

from pathlib import Path

import pytest

from sim.engine.setup import ProgramSetup, RobotUse, RunSetup, TimedLine
from sim.trace.events import (
    CallbackStarted,
    LineEnded,
    LineGiven,
    LineSaid,
    Logged,
    Notice,
    Printed,
    ProcessAppeared,
    ProcessEnded,
    RobotMoved,
    ThreadAppeared,
)
from sim.trace.timeline import Timeline
from tests.support.engine_runs import SECOND, Run, run_to_end

TALKER = """
import sys
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32

class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.count = 0
        self.publisher = self.create_publisher(Int32, "numbers", 10)
        self.create_timer(1.0, self.tick)

    def tick(self):
        self.count += 1
        self.publisher.publish(Int32(data=self.count))
        self.get_logger().debug(f"sent {self.count}")

def main():
    rclpy.init(args=sys.argv)
    print("talker", sys.argv[1:], rclpy.get_default_context() is rclpy.get_default_context())
    rclpy.spin(Talker())
"""

LISTENER = """
import sys
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32

class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.create_subscription(Int32, "numbers", self.heard, 10)

    def heard(self, number):
        self.get_logger().info(f"heard {number.data}")
        if number.data == 2:
            rclpy.shutdown()

def main():
    print("listener", sys.argv[1:])
    rclpy.init()
    node = Listener()
    rclpy.spin(node)
    print("done")
    sys.exit(3)
"""


def run_files(folder: Path, *sources: str, seconds: float = 3.5, **options: object) -> Run:
    programs = []
    for number, source in enumerate(sources):
        path = folder / f"program{number}.py"
        path.write_text(source)
        programs.append(ProgramSetup(str(path), ("-x", "1")))
    setup = RunSetup(
        title="several",
        programs=tuple(programs),
        speed=None,
        until=round(seconds * SECOND),
        robot=RobotUse.WHEN_USED,
        **options,  # type: ignore[arg-type]
    )
    return run_to_end(setup)


def of(run: Run, kind: type) -> list[object]:
    return [event for event in run.events if isinstance(event, kind)]


def test_each_program_has_its_own_context_executor_and_arguments(tmp_path: Path) -> None:
    run = run_files(tmp_path, TALKER, LISTENER)
    assert run.loss is None
    assert [(event.process, event.label) for event in run.events if isinstance(event, ProcessAppeared)] == [
        (1, "program0-1"),
        (2, "program1-2"),
    ]
    printed = [(event.process, event.text) for event in run.events if isinstance(event, Printed)]
    assert printed == [(1, "talker ['-x', '1'] True"), (2, "listener ['-x', '1']"), (2, "done")]
    logged = [(event.logger, event.text) for event in run.events if isinstance(event, Logged)]
    assert logged == [("listener", "heard 1"), ("listener", "heard 2")]
    ended, _ = (event for event in run.events if isinstance(event, ProcessEnded))
    assert (ended.t, ended.process, ended.status) == (2 * SECOND, 2, 3)
    ticks = [event.t for event in run.events if isinstance(event, CallbackStarted)]
    assert max(ticks) == 3 * SECOND, "the talker goes on when the listener has shut its own context down"


def test_lanes_name_the_program_of_each_thread(tmp_path: Path) -> None:
    run = run_files(tmp_path, TALKER, LISTENER)
    timeline = Timeline()
    timeline.extend(run.events)
    names = [thread.name for thread in timeline.threads.values()]
    assert names == ["program0-1 MainThread", "program1-2 MainThread"]
    assert [event.process for event in run.events if isinstance(event, ThreadAppeared)] == [1, 2]


def test_the_run_fails_with_the_first_program_that_does_and_ends_with_the_last(tmp_path: Path) -> None:
    run = run_files(tmp_path, "def main():\n    raise ValueError('no')", "import time\ntime.sleep(2)")
    ended = run.events[-1]
    assert ended.t == 2 * SECOND
    told = [event.text for event in run.events if isinstance(event, Notice)]
    assert told == ["program0-1: program0.py:2: the program raised ValueError: no"]
    assert getattr(ended, "reason", "") == "program0-1: program0.py:2: the program raised ValueError: no"


def test_a_program_that_ends_runs_its_exit_functions_and_flushes_its_files_while_others_go_on(
    tmp_path: Path,
) -> None:
    (tmp_path / "shared.py").write_text("import atexit\natexit.register(print, 'shared')")
    ends = """
import atexit, time, weakref
import shared
atexit.register(print, "first", end=" of all\\n")
@atexit.register
def fails():
    raise ValueError("no")
@atexit.register
def unwanted():
    print("unwanted")
atexit.unregister(unwanted)
atexit.register(print, "last")
shared.log = open(__file__ + ".csv", "w")
shared.log.write("1,2")
shared.kept = [fails]
weakref.finalize(fails, print, "finalizer")
time.sleep(1)
"""
    goes_on = """
import atexit, time
import shared
atexit.register(lambda: print("done"))
time.sleep(2)
print(open(__file__.replace("1.py", "0.py.csv")).read())
"""
    run = run_files(tmp_path, ends, goes_on)
    printed = [
        (event.t / SECOND, event.process, event.text)
        for event in run.events
        if isinstance(event, Printed) and not event.error
    ]
    assert printed == [
        (1, 1, "last"),
        (1, 1, "first of all"),
        (2, 2, "1,2"),
        (2, 2, "done"),
        (2, 0, "finalizer"),
        (2, 0, "shared"),
    ]
    (told,) = (event for event in run.events if isinstance(event, Notice))
    assert told.text == "program0.py:7: ValueError: no; Python drops what comes out of fails"
    assert told.t == SECOND
    ended = [event.t / SECOND for event in run.events if isinstance(event, ProcessEnded)]
    assert ended == [1, 2]


def test_a_program_that_failed_fails_the_run_even_when_its_time_is_up(tmp_path: Path) -> None:
    run = run_files(tmp_path, "def main():\n    raise ValueError('no')", TALKER)
    assert run.ending.failed
    assert run.ending.reason == (
        "its time was up; program0-1: program0.py:2: the program raised ValueError: no"
    )


def test_log_levels_are_each_programs_own(tmp_path: Path) -> None:
    loud = TALKER.replace(
        "rclpy.init(args=sys.argv)", "rclpy.init(args=['--ros-args', '--log-level', 'debug'])"
    )
    run = run_files(tmp_path, loud, TALKER, seconds=1.5)
    talkers = {event.thread for event in run.events if isinstance(event, Logged) and event.text == "sent 1"}
    names = {event.thread: event.process for event in run.events if isinstance(event, ThreadAppeared)}
    assert {names[thread] for thread in talkers} == {1}


def test_a_program_that_never_spins_its_callbacks_is_told_so(tmp_path: Path) -> None:
    source = TALKER.replace("rclpy.spin(Talker())", "Talker()")
    run = run_files(tmp_path, source)
    assert "without spinning" in getattr(run.events[-1], "reason", "")


def test_a_file_with_neither_main_nor_a_deed_is_told_so(tmp_path: Path) -> None:
    run = run_files(tmp_path, "import rclpy\n\nclass A:\n    pass\n")
    assert getattr(run.events[-1], "reason", "") == (
        "program0.py defines no main() and runs nothing at its top level; add a main() that spins a node"
    )


SPINNER = """
import rclpy
from rclpy.node import Node
from nav_msgs.msg import Odometry
rclpy.init()
node = Node("n")
{body}
rclpy.spin(node)
"""


def test_the_robot_comes_with_its_first_use_and_not_before(tmp_path: Path) -> None:
    without = run_files(tmp_path, SPINNER.format(body="node.create_timer(0.5, lambda: None)"), seconds=1.0)
    assert not any(event.__class__.__name__ == "RobotMoved" for event in without.events)
    body = "node.create_subscription(Odometry, 'odom', lambda odom: print(odom.child_frame_id), 10)"
    used = run_files(tmp_path, SPINNER.format(body=body), seconds=0.2)
    assert [event.text for event in used.events if isinstance(event, Printed)][:1] == ["base_footprint"]
    asked = SPINNER.replace("nav_msgs.msg import Odometry", "std_srvs.srv import Empty").format(
        body="print(node.create_client(Empty, '/reset_world').wait_for_service(1.0))"
    )
    assert [event.text for event in run_files(tmp_path, asked).events if isinstance(event, Printed)] == [
        "True"
    ]


@pytest.mark.parametrize("robot_first", [True, False])
def test_the_robot_stays_out_where_a_program_publishes_what_its_sensors_do(
    tmp_path: Path, robot_first: bool
) -> None:
    body = (
        "node.create_subscription(Odometry, 'odom', lambda odom: print(odom.child_frame_id), 10)",
        "odom = node.create_publisher(Odometry, 'odom', 10)",
        "node.create_timer(0.1, lambda: odom.publish(Odometry(child_frame_id='own')))",
    )
    run = run_files(tmp_path, SPINNER.format(body="\n".join(body if robot_first else body[1:] + body[:1])))
    assert {event.text for event in run.events if isinstance(event, Printed)} == {"own"}
    told = [event.text for event in run.events if isinstance(event, Notice)]
    assert told == ["the program publishes /odom itself, so the lessons' robot stays out"]
    timeline = Timeline()
    timeline.extend(run.events)
    assert timeline.arena is None
    assert not of(run, RobotMoved)


def test_lines_are_carried_out_at_their_moments(tmp_path: Path) -> None:
    lines = (TimedLine(1_500_000_000, "ros2 topic list"), TimedLine(2_000_000_000, "ros2 topic frobnicate"))
    run = run_files(tmp_path, TALKER, lines=lines)
    given = [(event.t, event.line) for event in run.events if isinstance(event, LineGiven)]
    assert given == [(1_500_000_000, 1), (2_000_000_000, 2)]
    said = [event.text for event in run.events if isinstance(event, LineSaid) and event.line == 1]
    assert said == ["/numbers", "/parameter_events", "/rosout"]
    ends = {event.line: event.status for event in run.events if isinstance(event, LineEnded)}
    assert ends == {1: 0, 2: 2}


def test_the_environment_can_be_joined_with_other_variables(tmp_path: Path) -> None:
    source = """
import os
os.environ |= {"COLOUR": "blue"}
print((os.environ | {"SIZE": "2"})["COLOUR"], ({"COLOUR": "red"} | os.environ)["COLOUR"])
"""
    run = run_files(tmp_path, source, TALKER)
    assert "blue blue" in [event.text for event in run.events if isinstance(event, Printed)]


def test_what_a_line_logs_and_prints_is_its_own_output(tmp_path: Path) -> None:
    offer = "topic pub -1 -w 0 --qos-reliability best_effort /numbers std_msgs/msg/Int32"
    run = run_files(tmp_path, LISTENER, lines=(TimedLine(SECOND, offer),), seconds=3.0)
    (warning,) = (each for each in run.events if isinstance(each, LineSaid) and "[WARN]" in each.text)
    assert warning.error
    assert "incompatible QoS" in warning.text
    others = [each.text for each in run.events if isinstance(each, Printed | Logged)]
    assert not any("_ros2cli" in text for text in others)


def test_a_run_without_programs_ends_with_its_lines(tmp_path: Path) -> None:
    run = run_files(tmp_path, lines=(TimedLine(0, "ros2 node list"), TimedLine(SECOND, "ros2 topic list")))
    assert run.events[-1].t == SECOND
    assert not of(run, Notice)


def test_the_same_run_gives_the_same_trace(tmp_path: Path) -> None:
    lines = (TimedLine(1_200_000_000, "ros2 topic pub --once /numbers std_msgs/msg/Int32 '{data: 7}'"),)
    first, second = (run_files(tmp_path, TALKER, LISTENER, lines=lines) for _ in range(2))
    assert first.events == second.events
    assert any(isinstance(event, Logged) and event.text == "heard 7" for event in first.events)
