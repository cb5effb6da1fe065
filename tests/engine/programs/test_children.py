"""Processes that a program starts with multiprocessing: they compute and print, and ROS stays with it."""

from pathlib import Path

import pytest

from sim.engine.setup import ProgramSetup, RunSetup
from sim.trace.events import Printed
from tests.support.engine_runs import SECOND, Run, run_to_end

pytestmark = pytest.mark.usefixtures("fresh_engines")

PROGRAM = """
import multiprocessing
import rclpy

def child(queue, node):
    print("in the child")
    queue.put(6 * 7)
    if node is not None:
        node.get_logger().info("from the child")

def main():
    rclpy.init()
    queue = multiprocessing.Queue()
    node = rclpy.create_node("n")
    process = multiprocessing.Process(target=child, args=(queue, WHO))
    process.start()
    print(queue.get())
    process.join()
    print("exit", process.exitcode)

main()
"""


def run(folder: Path, source: str, clock: str = "real") -> Run:
    path = folder / "program.py"
    path.write_text(source)
    setup = RunSetup(
        title="children", programs=(ProgramSetup(str(path), ()),), clock=clock, until=20 * SECOND
    )
    return run_to_end(setup)


def printed(run: Run) -> list[str]:
    return [event.text for event in run.events if isinstance(event, Printed)]


def test_a_child_computes_and_prints(tmp_path: Path) -> None:
    ended = run(tmp_path, PROGRAM.replace("WHO", "None"))
    assert sorted(printed(ended)) == ["42", "exit 0", "in the child"]
    assert not ended.ending.failed


@pytest.mark.slow
def test_a_child_that_uses_ros_is_told_that_it_cannot(tmp_path: Path) -> None:
    lines = printed(run(tmp_path, PROGRAM.replace("WHO", "node")))
    assert any("cannot use ROS here, only compute and print" in line for line in lines)
    assert "exit 1" in lines


@pytest.mark.slow
def test_on_virtual_time_there_are_no_children(tmp_path: Path) -> None:
    ended = run(tmp_path, PROGRAM.replace("WHO", "None"), clock="virtual")
    assert "multiprocessing does not work on virtual time; use --clock real" in ended.ending.reason
