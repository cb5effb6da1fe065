"""Launch files in an engine: their programs are processes of the run, on the run's time."""

from pathlib import Path

import pytest

from sim.engine.setup import ProgramSetup, RobotUse, RunSetup, TimedLine
from sim.trace.events import LineEnded, LineSaid, Logged, NodeAppeared, Notice, Printed, ProcessEnded
from tests.support.daily import first_row_daily
from tests.support.engine_runs import SECOND, Run, run_to_end

NODE = """
import sys
import rclpy
from rclpy.node import Node

class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.declare_parameter("period", 1.0)
        self.declare_parameter("last", 100)
        self.count = 0
        self.create_timer(self.get_parameter("period").value, self.tick)

    def tick(self):
        self.count += 1
        self.get_logger().info(f"{self.count}")
        print("printed")
        if self.count == self.get_parameter("last").value:
            sys.exit(4)

def main(args=None):
    rclpy.init(args=args)
    node = Counter()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
"""

SETUP = """
from glob import glob
from setuptools import setup
package_name = "counting"
setup(
    name=package_name,
    packages=[package_name],
    data_files=[("share/" + package_name + "/launch", glob("launch/*.launch.py"))],
    entry_points={"console_scripts": ["counter = counting.counter:main"]},
)
"""

MANIFEST = (
    "<package format='3'><name>counting</name><version>0.0.0</version><description>d</description>"
    "<maintainer email='a@b.c'>m</maintainer><license>L</license></package>"
)


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A workspace with a package whose node counts."""
    root = tmp_path / "src" / "counting"
    (root / "counting").mkdir(parents=True)
    (root / "launch").mkdir()
    (root / "package.xml").write_text(MANIFEST)
    (root / "setup.py").write_text(SETUP)
    (root / "counting" / "__init__.py").touch()
    (root / "counting" / "counter.py").write_text(NODE)
    return root


def launch_file(package: Path, body: str) -> Path:
    path = package / "launch" / "it.launch.py"
    path.write_text(
        "from launch import LaunchDescription\n"
        "from launch.actions import *\n"
        "from launch.event_handlers import OnProcessExit, OnProcessIO\n"
        "from launch.substitutions import LaunchConfiguration\n"
        "from launch_ros.actions import Node\n"
        f"def generate_launch_description():\n    return LaunchDescription([{body}])\n"
    )
    return path


def run(path: Path, *arguments: str, seconds: float = 3.5, lines: tuple[TimedLine, ...] = ()) -> Run:
    return run_to_end(
        RunSetup(
            title="launch",
            programs=(ProgramSetup(str(path), arguments),),
            speed=None,
            until=round(seconds * SECOND),
            lines=lines,
            robot=RobotUse.NEVER,
        )
    )


def printed(run: Run) -> list[str]:
    return [event.text for event in run.events if isinstance(event, Printed)]


def test_a_node_that_does_not_take_ctrl_c_ends_by_its_signal(package: Path) -> None:
    uncaught = NODE.replace("except KeyboardInterrupt", "except ValueError")
    (package / "counting" / "counter.py").write_text(uncaught)
    said = printed(run(launch_file(package, 'Node(package="counting", executable="counter")')))
    assert any("[ERROR] [counter-1]: process has died [pid 1, exit code -2, cmd" in line for line in said)


def test_nodes_get_names_namespaces_parameters_and_time(package: Path) -> None:
    body = """
        DeclareLaunchArgument("period", default_value="1.0"),
        Node(package="counting", executable="counter", name="slow", output="screen",
             parameters=[{"period": LaunchConfiguration("period")}]),
        TimerAction(period=1.0, actions=[Node(package="counting", executable="counter", namespace="late")]),
    """
    result = run(launch_file(package, body), "period:=2.0")
    assert [event.name for event in result.events if isinstance(event, NodeAppeared)] == [
        "/slow",
        "/late/counter",
    ]
    logged = [(event.t / SECOND, event.logger) for event in result.events if isinstance(event, Logged)]
    assert logged == [(2.0, "slow"), (2.0, "late.counter"), (3.0, "late.counter")]
    assert printed(result)[:5] == [
        "[INFO] [launch]: Default logging verbosity is set to INFO",
        "[INFO] [counter-1]: process started with pid [1]",
        "[INFO] [counter-2]: process started with pid [2]",
        "printed",
        "[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)",
    ]
    notices = [event.text for event in result.events if isinstance(event, Notice)]
    assert notices == [
        "counter-2 prints to stdout, which ros2 launch only shows with output='screen'; "
        "its log goes to stderr and is shown"
    ]


def test_a_process_that_dies_is_told_of_and_may_be_followed_or_started_again(package: Path) -> None:
    body = """
        node := Node(package="counting", executable="counter", parameters=[{"last": 1}]),
        RegisterEventHandler(OnProcessExit(target_action=node, on_exit=[LogInfo(msg="gone")])),
        Node(package="counting", executable="counter", parameters=[{"last": 2, "period": 0.5}], respawn=True),
    """
    result = run(launch_file(package, body), seconds=2.2)
    ends = [
        (event.t / SECOND, event.process, event.status)
        for event in result.events
        if isinstance(event, ProcessEnded)
    ]
    assert ends == [(1.0, 1, 4), (1.0, 2, 4), (2.0, 3, 4), (2.2, 4, 0)]
    said = printed(result)
    assert any("[ERROR] [counter-1]: process has died [pid 1, exit code 4" in line for line in said)
    assert "[INFO] [launch.user]: gone" in said or "[INFO] [launch]: gone" in said


def test_what_nodes_print_and_log_starts_others(package: Path) -> None:
    """As in ROS 2's tutorial on event handlers, where a node waits for what another one says."""
    body = """
        node := Node(package="counting", executable="counter", parameters=[{"last": 2}], name="first"),
        RegisterEventHandler(OnProcessIO(
            target_action=node,
            on_stdout=lambda event: LogInfo(msg="printed: " + event.text.decode().strip()),
            on_stderr=lambda event: [LogInfo(msg="logged: " + event.text.decode().strip()),
                                     ExecuteProcess(cmd=["ros2", "node", "list"], output="screen")],
            handle_once=True,
        )),
    """
    said = printed(run(launch_file(package, body)))
    (told,) = [line for line in said if "launch.user" in line]
    assert told == "[INFO] [launch.user]: logged: [INFO] [1700000001.000000000] [first]: 1"
    assert "/first" in said
    assert "[INFO] [launch.user]: printed: printed" in printed(
        run(launch_file(package, body.replace("handle_once=True,", "")))
    )


def test_a_line_of_a_launch_file_is_carried_out(package: Path) -> None:
    body = """
        Node(package="counting", executable="counter"),
        TimerAction(period=1.5, actions=[ExecuteProcess(cmd=["ros2", "node", "list"], output="screen")]),
    """
    assert "/counter" in printed(run(launch_file(package, body)))


def test_ctrl_c_on_a_launch_line_ends_its_processes(package: Path) -> None:
    launch_file(package, 'Node(package="counting", executable="counter")')
    setup = RunSetup(
        title="lines",
        programs=(),
        speed=None,
        until=10 * SECOND,
        lines=(
            TimedLine(0, "ros2 launch counting it.launch.py"),
            TimedLine(2 * SECOND, "ros2 node list"),
        ),
        packages=(str(package.parent),),
        robot=RobotUse.NEVER,
    )
    result = run_to_end(setup)
    assert [event.text for event in result.events if isinstance(event, LineSaid) and event.line == 2] == [
        "/counter"
    ]
    (ended,) = (event for event in result.events if isinstance(event, LineEnded) and event.line == 1)
    assert ended.t == result.ending.t == 10 * SECOND


@pytest.mark.parametrize(
    ("body", "sentence"),
    first_row_daily(
        ("Node(package='nothing', executable='x')", "nothing"),
        ("Node(package='counting', executable='x')", "counter"),
        ("Node(package='counting')", "executable"),
        ("1/0", "ZeroDivisionError"),
        ("DeclareLaunchArgument('speed')", "speed"),
    ),
)
def test_what_is_wrong_in_a_launch_file_ends_the_run_with_its_line(
    package: Path, body: str, sentence: str
) -> None:
    result = run(launch_file(package, body))
    assert result.loss is None
    told = " ".join([result.ending.reason, *printed(result)])
    assert sentence in told
    assert "it.launch.py" in told
    assert result.ending.failed


@pytest.mark.slow
def test_the_same_launch_gives_the_same_trace(package: Path) -> None:
    path = launch_file(package, 'Node(package="counting", executable="counter"),' * 3)
    assert run(path).events == run(path).events


@pytest.mark.parametrize(
    ("name", "is_one"), [("a.launch.py", True), ("robot.xml", True), ("b.yaml", True), ("node.py", False)]
)
def test_what_is_no_python_is_taken_for_a_launch_file_and_not_run_as_python(name: str, is_one: bool) -> None:
    assert ProgramSetup(name).is_launch_file is is_one
