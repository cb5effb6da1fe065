"""A chain of messages through two processes on real rclpy."""

import sys
from pathlib import Path

import pytest

from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.lesson_setup import RunRequest
from sim.engine.setup import RealRos
from sim.trace.figures.chains import StepKind, chain
from tests.real.programs import HEAD, TAIL, needs_ros
from tests.support.engine_runs import run_to_end

pytestmark = [needs_ros, pytest.mark.slow]

LOOK = """
class Tried(Node):
    def __init__(self):
        super().__init__("look")
        self.scan = self.create_publisher(String, "scan", 10)
        self.points = self.create_publisher(String, "points", 10)
        self.create_timer(0.2, lambda: self.scan.publish(String()))
        self.create_subscription(String, "scan", self.look, 10)

    def look(self, message):
        time.sleep(0.02)
        self.points.publish(message)
        time.sleep(0.015)
"""
STEER = """
class Tried(Node):
    def __init__(self):
        super().__init__("steer")
        self.cmd = self.create_publisher(String, "cmd", 10)
        self.create_subscription(String, "points", self.steer, 10)

    def steer(self, message):
        time.sleep(0.03)
        self.cmd.publish(message)
"""


def test_a_chain_through_two_processes_takes_what_its_callbacks_take(tmp_path: Path) -> None:
    files = [tmp_path / "look.py", tmp_path / "steer.py"]
    for file, body in zip(files, (LOOK, STEER), strict=True):
        file.write_text(HEAD + body + TAIL.format(executor="SingleThreadedExecutor()"))
    changes = Changes(real=RealRos(sys.executable))
    request = RunRequest(files=files, seconds=4.0, robot=False, changes=changes)
    found = chain(run_to_end(request.setup()).timeline, ("/scan", "/cmd"))
    assert found.path == ("/scan", "/points", "/cmd")
    assert len(found.whole_chain) >= 10
    for run in found.whole_chain:
        assert sum(step.length for step in run.steps) == run.latency >= 50_000_000
        runs = [step.length / 1e6 for step in run.steps if step.kind is StepKind.RUNS]
        assert all(took >= slept for took, slept in zip(runs, (20, 30), strict=True))
    assert min(run.latency for run in found.whole_chain) < 80_000_000  # a busy machine delays some
