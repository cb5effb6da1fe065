"""What a run on real rclpy starts: programs, launch files, their terminal and their ends."""

import signal
import sys
import time
from pathlib import Path

import msgspec
import pytest

from sim.engine.failures.cause import Cause
from sim.engine.setup import Keyboard, ProgramSetup, RealRos
from sim.trace.events import CallbackEnded, KeyboardAsked, ProcessAppeared, ProcessEnded, Reading, Typed
from tests.real import programs
from tests.real.launching import Launched
from tests.real.programs import needs_ros
from tests.support.engine_runs import program_setup, run_to_end

_LAUNCH = """
from launch import LaunchDescription
from launch.actions import *
from launch.event_handlers import OnProcessExit, OnProcessIO
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([{actions}])
"""


@pytest.fixture
def launched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Launched:
    (tmp_path / "bin").mkdir()
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}:/usr/bin:/bin")
    return Launched(tmp_path)


def program(folder: Path, text: str, name: str = "tried.py") -> ProgramSetup:
    (folder / name).write_text(text)
    return ProgramSetup(str(folder / name))


def launch_file(folder: Path, actions: str, *arguments: str) -> ProgramSetup:
    (folder / "all.launch.py").write_text(_LAUNCH.format(actions=actions))
    return ProgramSetup(str(folder / "all.launch.py"), arguments)


def test_a_program_has_ended_though_its_child_keeps_its_output_open(launched: Launched) -> None:
    began = time.monotonic()
    text = "import subprocess, sys\nsubprocess.Popen(['sleep', '200'])\nprint('done')\n"
    started = launched.start(sys.executable, program(launched.folder, text))
    launched.to_end()
    assert time.monotonic() - began < 100
    assert started.outcome().reason == "the program returned"
    assert launched.printed == ["done"]
    (only,) = started._programs
    only.kill()


@pytest.mark.parametrize("before", ["", "import rclpy\n"])
def test_a_package_of_ros_that_is_missing_is_told_with_what_it_takes(launched: Launched, before: str) -> None:
    started = launched.start(sys.executable, program(launched.folder, before + "import tf2_ros\n"))
    launched.to_end()
    if before and "No module named 'rclpy'" in "".join(launched.printed):
        pytest.skip("no real rclpy")
    assert started.outcome().reason.endswith(
        "; PyPI has no wheel of tf2_ros: run without --on ros2, or with --python /usr/bin/python3 where ROS "
        "2 is installed, after sudo apt install ros-jazzy-tf2-ros-py"
    )


# the terminal


def test_a_prompt_is_shown_and_a_line_is_read(launched: Launched) -> None:
    launched.start(sys.executable, program(launched.folder, "print('hello', input('name? '))\n"))
    launched.until(lambda: launched.printed == ["name? "] and bool(launched.of(KeyboardAsked)))
    assert [event.reads for event in launched.of(KeyboardAsked)] == [Reading.LINES]  # type: ignore[attr-defined]
    launched.keyboard.type("bob\n")
    launched.to_end()
    assert launched.printed == ["name? ", "hello bob"]


def test_what_is_typed_before_it_is_asked_for_waits(launched: Launched) -> None:
    text = "import getpass\nprint(input())\nprint(getpass.getpass())\nprint(input())\n"
    launched.start(sys.executable, program(launched.folder, text))
    launched.keyboard.type("one\ntwo\nthree\n")
    launched.to_end()
    assert launched.printed == ["one", "two", "three"]


def test_a_password_is_told_in_dots(launched: Launched) -> None:
    text = "import getpass\nprint(len(getpass.getpass()))\n"
    launched.start(sys.executable, program(launched.folder, text))
    launched.until(lambda: bool(launched.of(KeyboardAsked)))
    launched.keyboard.type("secret\n")
    launched.to_end()
    assert launched.printed == ["6"]
    assert [event.text for event in launched.of(Typed)] == ["••••••\n"]  # type: ignore[attr-defined]


def test_single_keys_are_read_as_a_teleop_does(launched: Launched) -> None:
    text = """
import select, sys, termios, tty
usual = termios.tcgetattr(sys.stdin)
keys = ""
while len(keys) < 3:
    tty.setraw(sys.stdin.fileno())
    if select.select([sys.stdin], [], [], 0.1)[0]:
        keys += sys.stdin.read(1)
    termios.tcsetattr(sys.stdin, termios.TCSADRAIN, usual)
print(repr(keys))
"""
    launched.start(sys.executable, program(launched.folder, text))
    launched.until(lambda: bool(launched.of(KeyboardAsked)))
    assert [event.reads for event in launched.of(KeyboardAsked)] == [Reading.RAW]  # type: ignore[attr-defined]
    assert not launched.keyboard.interrupts("\x03")
    for key in "wa\x03":
        launched.keyboard.type(key)
    launched.to_end()
    assert launched.printed == ["'wa\\x03'"]


def test_ctrl_c_interrupts_where_the_terminal_says_so_and_the_input_ends(launched: Launched) -> None:
    text = "import sys\nprint([line for line in sys.stdin])\n"
    launched.start(sys.executable, program(launched.folder, text), keyboard=Keyboard.NOBODY)
    assert launched.keyboard.interrupts("\x03")
    launched.keyboard.type("one\ntwo", ends=True)
    launched.to_end()
    assert launched.printed == ["['one\\n', 'two']"]


# launch files


def test_a_launch_file_starts_processes_and_its_handlers_follow_them(launched: Launched) -> None:
    program(launched.folder, "import sys\nprint(sys.argv[1:])\nsys.exit(3)\n", "a.py")
    actions = f"""
        DeclareLaunchArgument("speed", default_value="1"),
        RegisterEventHandler(OnProcessExit(on_exit=[LogInfo(msg="it has died")])),
        Node(executable={str(launched.folder / "a.py")!r}, name="first", namespace="b", output="screen",
             parameters=[{{"speed": LaunchConfiguration("speed")}}], remappings=[("x", "y")],
             respawn=True, respawn_max_retries=1),
        RegisterEventHandler(OnProcessIO(on_stdout=lambda event: LogInfo(msg=f"{{event.text[:16]!r}}"))),
        ExecuteProcess(cmd=["ros2", "topic", "list"]),
    """
    started = launched.start(sys.executable, launch_file(launched.folder, actions, "speed:=7"))
    launched.to_end()
    (arguments, again) = [each for each in launched.printed if each.startswith("['--ros-args'")]
    assert arguments == again
    for word in ("'__node:=first'", "'__ns:=/b'", "'speed:=7'", "'x:=y'"):
        assert word in arguments
    assert launched.printed.count("[INFO] [launch.user]: it has died") == 3
    assert launched.printed.count("[INFO] [launch.user]: b\"['--ros-args', '\"") == 2
    assert launched.lines == [["ros2", "topic", "list"]]
    labels = [event.label for event in launched.of(ProcessAppeared)]  # type: ignore[attr-defined]
    assert labels == ["a.py-1", "ros2-2", "a.py-1"]
    ended = sorted(event.status for event in launched.of(ProcessEnded))  # type: ignore[attr-defined]
    assert ended == [0, 3, 3]
    assert started.outcome() == Cause("a.py-1: the program ended with exit code 3", failed=True)


def test_ctrl_c_ends_a_launch_as_it_would_in_a_terminal(launched: Launched) -> None:
    program(launched.folder, "import time\nprint('waits')\ntime.sleep(60)\n", "a.py")
    action = f"ExecuteProcess(cmd=['python3', {str(launched.folder / 'a.py')!r}], output='screen')"
    started = launched.start(sys.executable, launch_file(launched.folder, f"{action}, {action}"))
    launched.until(lambda: launched.printed.count("waits") == 2)
    started.interrupt()
    launched.to_end()
    assert "[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)" in launched.printed
    ended = [event.status for event in launched.of(ProcessEnded)]  # type: ignore[attr-defined]
    assert ended == [-signal.SIGINT] * 2
    assert not started.outcome().failed


def test_a_shutdown_after_some_time_ends_all(launched: Launched) -> None:
    program(launched.folder, "import time\ntime.sleep(60)\n", "a.py")
    actions = f"""ExecuteProcess(cmd=['python3', {str(launched.folder / "a.py")!r}]),
        TimerAction(period=0.2, actions=[EmitEvent(event=Shutdown(reason="enough"))])"""
    launched.start(sys.executable, launch_file(launched.folder, actions))
    launched.to_end()
    assert "[INFO] [python3-1]: sending signal 'SIGINT' to process[python3-1]" in launched.printed


@pytest.mark.parametrize(
    ("actions", "said"),
    [
        ("Node(package='nowhere', executable='x')", "all.launch.py:10: "),
        ("1 / 0", "all.launch.py:10: ZeroDivisionError: division by zero"),
    ],
)
def test_a_launch_file_that_cannot_be_carried_out_is_placed(
    launched: Launched, actions: str, said: str
) -> None:
    started = launched.start(sys.executable, launch_file(launched.folder, actions))
    launched.to_end()
    outcome = started.outcome()
    assert outcome.failed
    assert outcome.reason.startswith(said)


def test_a_package_runs_from_its_sources(launched: Launched) -> None:
    root = launched.folder / "src" / "demo"
    for name, text in {
        "package.xml": "<package><name>demo</name><version>0.1.0</version></package>",
        "setup.py": "from setuptools import setup\nsetup(name='demo', packages=['demo'], "
        "entry_points={'console_scripts': ['tell = demo.tell:main']})",
        "demo/__init__.py": "",
        "demo/other.py": "word = 'found'",
        "demo/tell.py": "import sys\nfrom demo.other import word\n"
        "def main():\n    print(word, *sys.argv[1:])\n",
    }.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    statuses: list[int] = []
    started = launched.start(sys.executable, program(launched.folder, ""))
    started.start_executable("demo", "tell", ["--ros-args"], statuses.append)
    launched.to_end()
    assert launched.printed == ["found --ros-args"]
    assert statuses == [0]


def test_where_ros_is_sourced_its_own_launch_is_used(launched: Launched) -> None:
    command = launched.folder / "bin" / "ros2"
    command.write_text('#!/bin/sh\necho "ros2 $@"\n')
    command.chmod(0o755)
    launched.environment["PATH"] = f"{command.parent}:/usr/bin:/bin"
    launched.start(sys.executable, launch_file(launched.folder, "1 / 0", "speed:=7"))
    launched.to_end()
    assert launched.printed == [f"ros2 launch {launched.folder / 'all.launch.py'} speed:=7"]


@needs_ros
@pytest.mark.slow
def test_what_a_program_starts_itself_is_watched_too(tmp_path: Path) -> None:
    node = tmp_path / "child.py"
    text = programs.HEAD + programs.STARVED + programs.TAIL.format(executor="SingleThreadedExecutor()")
    node.write_text(text)
    parent = tmp_path / "parent.py"
    parent.write_text(f"import subprocess, sys\nsubprocess.run([sys.executable, {str(node)!r}])\n")
    setup = program_setup(parent, 2.0, clock="real")
    run = run_to_end(msgspec.structs.replace(setup, real=RealRos()))
    (child,) = [event for event in run.events if isinstance(event, ProcessAppeared)]
    assert child.label.startswith("child.py-")
    assert set(run.timeline.nodes.values()) == {"/tried"}
    assert any(isinstance(event, CallbackEnded) for event in run.events)
