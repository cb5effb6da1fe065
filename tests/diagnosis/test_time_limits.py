"""A wait that ends by itself is told with its end, and never as one for ever."""

import os
from pathlib import Path

import pytest

from cbtui.runs.live.findings import FindingsMonitor
from sim.diagnosis.time_limits import ends_by_itself
from sim.quantities.nanoseconds import SECOND
from tests.support.engine_runs import run_program

PROGRAM = """
import threading
import time

import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class Caller(Node):
    def __init__(self):
        super().__init__("caller")
        self.create_service(SetBool, "own", self.serve)
        self.own = self.create_client(SetBool, "own")
        self.none = self.create_client(SetBool, "none")
        self.came = threading.Event()
        self.create_timer(1.0, self.tick)

    def serve(self, request, response):
        return response

    def call(self):
        future = self.own.call_async(SetBool.Request())
        future.add_done_callback(lambda _: self.came.set())
        return future

    def tick(self):
        WAIT


rclpy.init()
node = Caller()
BEFORE
rclpy.spin(node)
"""
IN_VAIN = "tick waits in vain for /own until 9.0 s; /own waits for group A, which tick"


def found_in(
    folder: Path, wait: str, seconds: float, before: str = "", clock: str = "virtual"
) -> FindingsMonitor:
    wait = wait.replace("\n", "\n        ")
    run = run_program(folder, PROGRAM.replace("WAIT", wait).replace("BEFORE", before), seconds, clock)
    monitor = FindingsMonitor(run.timeline)
    monitor.update()
    return monitor


@pytest.mark.parametrize(
    ("wait", "told"),
    [
        ("self.own.call(SetBool.Request(), timeout_sec=8.0)", IN_VAIN),
        ("self.call()\nself.came.wait(8.0)", IN_VAIN),
        (
            "self.none.wait_for_service(timeout_sec=8.0)",
            "tick waits in wait_for_service() until 9.0 s for /none, which nobody has offered so far",
        ),
    ],
)
def test_a_wait_with_a_timeout_is_told_with_its_end(tmp_path: Path, wait: str, told: str) -> None:
    monitor = found_in(tmp_path, wait, 5.0)
    (found,) = (each.explanation for each in monitor.findings if each.is_problem)
    assert found.what.startswith(told)
    assert (found.for_ever, found.until) == (False, 9 * SECOND)
    assert monitor.standstill() is None


def test_a_timeout_on_the_real_clock_is_seen_too(tmp_path: Path) -> None:
    monitor = found_in(tmp_path, "self.own.call(SetBool.Request(), timeout_sec=8.0)", 2.0, clock="real")
    (found,) = (each.explanation for each in monitor.findings if each.is_problem)
    assert 9 * SECOND <= found.until < 10 * SECOND


def test_a_timeout_that_is_over_was_a_wait_in_vain(tmp_path: Path) -> None:
    monitor = found_in(tmp_path, "self.own.call(SetBool.Request(), timeout_sec=1.0)", 2.5)
    told = [each.explanation.what for each in monitor.findings if each.name == "self made deadlock"]
    assert told[0].startswith("tick waited in vain for /own; ")


def test_a_program_that_waits_for_a_service_for_some_time_comes_to_spin_after_that(tmp_path: Path) -> None:
    monitor = found_in(tmp_path, "pass", 5.0, before="node.none.wait_for_service(timeout_sec=8.0)")
    told = next(each.explanation for each in monitor.findings if each.name == "service never comes")
    assert told.what == (
        "the program waits in wait_for_service() until 8.0 s for /none, which nobody has offered so far, "
        "and comes to no spin() before that"
    )
    assert not told.for_ever


def test_a_program_that_sleeps_before_it_spins_has_not_spun_so_far(tmp_path: Path) -> None:
    monitor = found_in(tmp_path, "pass", 4.0, before="time.sleep(8.0)")
    (told,) = (each.explanation.what for each in monitor.findings)
    assert told.endswith("and has come to no spin() so far")


@pytest.mark.parametrize(
    ("loop", "is_endless"),
    [
        ("while not future.done():", True),
        ("while rclpy.ok() and not future.done():", True),
        ("while not future.done() and time.monotonic() < end:", False),
        ("while not future.done() and self.get_clock().now().nanoseconds / 1e9 < end:", False),
        ("while not future.done() and tries > 0:\n    tries -= 1", False),
    ],
)
def test_a_loop_that_ends_by_itself_is_no_deadlock(tmp_path: Path, loop: str, is_endless: bool) -> None:
    start = "future, tries, end = self.call(), 160, time.monotonic() + 8.0\n"
    monitor = found_in(tmp_path, f"{start}{loop}\n    time.sleep(0.05)", 5.0)
    assert (monitor.standstill() is not None) is is_endless


def test_of_what_a_recording_calls_a_program_only_a_file_is_read(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    assert not any(ends_by_itself(path, 1) for path in (str(pipe), "/dev/zero", "null\0character"))


def test_a_loop_around_a_wait_with_a_timeout_may_last_for_ever(tmp_path: Path) -> None:
    loop = "while not self.none.wait_for_service(timeout_sec=1.0):\n    self.get_logger().info('waits')"
    monitor = found_in(tmp_path, loop, 5.0)
    (found,) = (each.explanation for each in monitor.findings if each.is_problem)
    assert found.for_ever


def test_a_loop_that_was_edited_is_read_anew(tmp_path: Path) -> None:
    file = tmp_path / "node.py"
    file.write_text("while not done:\n    pass\n")
    assert not ends_by_itself(str(file), 1)
    file.write_text("while time.monotonic() < end:\n    pass\n")
    assert ends_by_itself(str(file), 1)
