"""``ros2`` lines on real ROS 2: by the command of a ROS that is sourced, or by cbtui's own Python."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from selectors import DefaultSelector

import msgspec
import pytest

from sim.engine.setup import RealRos, TimedLine
from sim.quantities.nanoseconds import SECOND
from sim.real.programs import claimed_domain
from sim.real.ros2_lines import Ros2Lines
from sim.real.wire import ProgramEnded, decode_request
from sim.trace.events import (
    AnyEvent,
    LineCompleted,
    LineEnded,
    LineGiven,
    LineSaid,
    NodeAppeared,
    ProcessAppeared,
    Published,
)
from tests.real import programs
from tests.real.launching import LONGEST
from tests.real.programs import needs_ros
from tests.support.engine_runs import program_setup, run_to_end

_ROS2 = """#!/bin/sh
echo "given: $@"
echo "probed: $CBTUI_PROBE" >&2
test "$1" = wait && exec sleep 60
exit 3
"""


class Lines:
    """Lines that are carried out, and what was told of them."""

    def __init__(self, environment: dict[str, str]) -> None:
        self.events: list[AnyEvent] = []
        self._selector = DefaultSelector()
        self.lines = Ros2Lines(self._selector, environment, [], _ignore, self.events.append, None)

    def until(self, done: Callable[[], bool]) -> None:
        end = time.monotonic() + LONGEST
        while not done():
            assert time.monotonic() < end, self.events
            for key, _ in self._selector.select(0.005):
                key.data()
            self.lines.look()

    def said(self, line: int) -> list[tuple[str, bool]]:
        return [(e.text, e.error) for e in self.events if isinstance(e, LineSaid) and e.line == line]

    def status(self, line: int) -> int | None:
        return next((e.status for e in self.events if isinstance(e, LineEnded) and e.line == line), None)

    def stop(self) -> None:
        """End the lines, and what carries them out."""
        self.lines.stop()
        self.until(lambda: not self._selector.get_map())

    def result(self, line: int) -> tuple[list[tuple[str, bool]], int | None]:
        self.until(lambda: self.status(line) is not None)
        return sorted(self.said(line)), self.status(line)


def _ignore(_lines: object) -> None: ...


@pytest.fixture
def sourced(tmp_path: Path) -> Lines:
    (tmp_path / "ros2").write_text(_ROS2)
    (tmp_path / "ros2").chmod(0o755)
    return Lines({"PATH": f"{tmp_path}:/usr/bin:/bin", "CBTUI_PROBE": "here"})


def test_a_line_goes_to_the_command_of_a_sourced_ros(sourced: Lines) -> None:
    sourced.lines.begin(1, "ros2 topic echo '/a b'")
    assert sourced.result(1) == ([("given: topic echo /a b", False), ("probed: ", True)], 3)
    assert isinstance(sourced.events[0], LineGiven)


def test_what_a_line_starts_is_watched(sourced: Lines) -> None:
    sourced.lines.begin(1, "ros2 run demo talker")
    assert sourced.result(1)[0] == [("given: run demo talker", False), ("probed: here", True)]


def test_a_line_is_interrupted(sourced: Lines) -> None:
    sourced.lines.begin(1, "ros2 wait")
    sourced.lines.begin(2, "ros2 doctor")
    sourced.until(lambda: len(sourced.said(1)) == 2)
    sourced.lines.interrupt(1)
    assert sourced.result(1)[1] == -2
    assert sourced.result(2)[1] == 3
    sourced.lines.interrupt(1)


def test_a_line_that_is_none_says_so(sourced: Lines) -> None:
    sourced.lines.begin(1, "ros2 topic pub /x 'open")
    said, status = sourced.result(1)
    assert said == [("a quote is not closed: there is no second ' in the line", True)]
    assert status == 2


def test_without_any_ros_a_line_says_what_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "/bin/false")
    lines = Lines({"PATH": "/nowhere"})
    lines.lines.begin(1, "ros2 topic list")
    (said,), status = lines.result(1)
    assert said[0].startswith("ros2 lines need rclpy beside cbtui (/bin/false), or the command ros2")
    assert status == 1
    lines.lines.complete(2, "ros2 to", 7)
    assert lines.events[-1] == LineCompleted(0, 2, 7, ())
    lines.lines.stop()


def test_requests_come_back_as_they_were() -> None:
    ended = ProgramEnded(3, 1)
    assert decode_request(msgspec.json.encode(ended)) == ended


# on real rclpy

_TALKS = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.declare_parameter("speed", 0.5)
        self.publisher = self.create_publisher(String, "news", 10)
        self.create_timer(0.1, self.tell)
        self.create_subscription(String, "heard", self.hear, 10)
        self.create_service(SetBool, "switch", self.serve)

    def tell(self):
        self.publisher.publish(String(data="x"))

    def hear(self, message):
        pass

    def serve(self, request, response):
        response.message = "served"
        return response
"""
_LINES = {
    "ros2 topic list": "/heard",
    "ros2 topic list -t": "/news [std_msgs/msg/String]",
    "ros2 topic info /news": "Publisher count: 1",
    "ros2 topic echo --once /news": "data: x",
    "ros2 topic pub --once /heard std_msgs/msg/String '{data: hi}'": "publisher: beginning loop",
    "ros2 node list": "/tried",
    "ros2 node info /tried": "    /switch: std_srvs/srv/SetBool",
    "ros2 service call /switch std_srvs/srv/SetBool '{data: true}'": (
        "std_srvs.srv.SetBool_Response(success=False, message='served')"
    ),
    "ros2 param get /tried speed": "Double value is: 0.5",
    "ros2 param set /tried speed 1.5": "Set parameter successful",
    "ros2 action list": "",
    "ros2 topic pub /heard no_msgs/msg/X": (
        "The passed message type is invalid: there is no no_msgs.msg for cbtui's own Python"
    ),
}


@needs_ros
@pytest.mark.slow
def test_lines_act_on_the_real_graph(tmp_path: Path) -> None:
    path = tmp_path / "tried.py"
    path.write_text(programs.HEAD + _TALKS + programs.TAIL.format(executor="SingleThreadedExecutor()"))
    lines = tuple(TimedLine(round((8 + 0.2 * n) * SECOND), text) for n, text in enumerate(_LINES))
    setup = program_setup(path, 20.0, clock="real")
    run = run_to_end(msgspec.structs.replace(setup, real=RealRos(), lines=lines))
    for number, (text, wanted) in enumerate(_LINES.items(), start=1):
        said = [e.text for e in run.events if isinstance(e, LineSaid) and e.line == number]
        assert wanted in ["", *said], (text, said)
    assert {e.line for e in run.events if isinstance(e, LineEnded)} == {*range(1, len(_LINES) + 1)}
    assert "/heard" in {event.topic for event in run.events if isinstance(event, Published)}


@needs_ros
@pytest.mark.slow
def test_a_launch_file_starts_real_nodes(tmp_path: Path) -> None:
    node = tmp_path / "tried.py"
    node.write_text(programs.HEAD + _TALKS + programs.TAIL.format(executor="SingleThreadedExecutor()"))
    path = tmp_path / "all.launch.py"
    path.write_text(
        "from launch import LaunchDescription\n"
        "from launch_ros.actions import Node\n"
        "def generate_launch_description():\n"
        f"    return LaunchDescription([Node(executable={json.dumps(str(node))}, name=each, "
        "remappings=[('news', 'chatter')]) for each in ('one', 'two')])\n"
    )
    run = run_to_end(msgspec.structs.replace(program_setup(path, 6.0, clock="real"), real=RealRos()))
    assert [e.label for e in run.events if isinstance(e, ProcessAppeared)] == ["tried.py-1", "tried.py-2"]
    assert set(run.timeline.nodes.values()) == {"/one", "/two"}
    assert "/chatter" in {event.topic for event in run.events if isinstance(event, Published)}
    assert run.ending.time_was_up
    assert not run.ending.failed


_WHEN_TOLD = """
import sys
print("ready", flush=True)
sys.stdin.read()
"""
"""A program that has imported all it needs, and makes its node as soon as its input ends."""


@needs_ros
@pytest.mark.slow
def test_a_line_waits_until_discovery_has_found_the_nodes_that_the_run_knows(tmp_path: Path) -> None:
    domain, claim = claimed_domain()
    environment = {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    file = tmp_path / "tried.py"
    file.write_text(
        f"{programs.HEAD}{_WHEN_TOLD}{programs.MISSES_TICKS}"
        + programs.TAIL.format(executor="SingleThreadedExecutor()")
    )
    told = subprocess.PIPE
    with claim, subprocess.Popen([sys.executable, file], env=environment, stdin=told, stdout=told) as node:
        assert node.stdin is not None
        assert node.stdout is not None
        lines = Lines(environment)
        try:
            assert node.stdout.readline() == b"ready\n"
            lines.lines.prepare()
            lines.lines.hear([NodeAppeared(0, 1, "/tried")])
            lines.lines.begin(1, "ros2 param set /tried use_sim_time false")
            until = time.monotonic() + 2.5  # what discovery takes now and then
            lines.until(lambda: time.monotonic() > until)
            node.stdin.close()
            assert lines.result(1) == ([("Set parameter successful", False)], 0)
        finally:
            node.kill()
            lines.stop()
