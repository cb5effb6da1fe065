"""Every cure that names a group or a number of threads ends what it is offered for, when it is tried."""

import re
from pathlib import Path

import msgspec
import pytest

from cbtui.runs.setup.lesson_setup import setup_for
from lessons.catalogue import find
from sim.diagnosis import diagnose
from sim.engine.setup import GroupChange, RunSetup, TimedCall
from sim.trace.timeline import Timeline
from tests.support.engine_runs import SECOND, program_setup, run_to_end

Complaint = tuple[str, str, str]
"""A rule, and whom it is about and whom it blames."""
Cure = tuple[str, int | None]
"""A callback that gets a group of its own ("": none), and a number of threads."""

_GROUP = re.compile(r"give (\w+) a (?:callback group of its own|MutuallyExclusiveCallbackGroup)")
_THREADS = re.compile(r"num_threads=(\d+)")

RIVALS = """
import time
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Busy(Node):
    def __init__(self):
        super().__init__("busy")
        self.create_timer(4.0, self.long)
        self.create_timer(4.0, self.rival, MutuallyExclusiveCallbackGroup())
        self.create_timer(0.5, self.quick)

    def long(self):
        time.sleep(3.0)

    def rival(self):
        time.sleep(3.5)

    def quick(self):
        pass


rclpy.init()
node = Busy()
rclpy.spin_once(node, timeout_sec=1.0)
executor = SingleThreadedExecutor()
executor.add_node(node)
executor.spin()
"""

TWO_EXECUTORS = """
import threading
import time
import rclpy

rclpy.init()
near, far = rclpy.create_node("near"), rclpy.create_node("far")
near.create_timer(2.0, lambda: time.sleep(1.0))


def quick():
    pass


def slow():
    time.sleep(0.4)


near.create_timer(0.5, quick)
far.create_timer(0.5, slow)
other = rclpy.executors.SingleThreadedExecutor()
other.add_node(far)
threading.Thread(target=other.spin, daemon=True).start()
rclpy.spin(near)
"""


def complaints(timeline: Timeline) -> dict[Complaint, str]:
    """What waits are found, with the cure of each."""
    names = {0: ""} | {each.id: each.spoken_name for each in timeline.entities.values()}
    return {
        (each.rule.id, names[each.subject], names[each.culprit]): each.explained(timeline).cure
        for each in diagnose(timeline)
    }


def cure_in(text: str) -> Cure | None:
    group, threads = _GROUP.search(text), _THREADS.search(text)
    if group is None and threads is None:
        return None
    return group[1] if group else "", int(threads[1]) if threads else None


def tried(setup: RunSetup, cure: Cure) -> RunSetup:
    callback, threads = cure
    groups = (GroupChange("", callback, "own"),) if callback else ()
    return msgspec.structs.replace(setup, groups=groups, threads=threads or setup.threads)


def check_cures(setup: RunSetup, expected: set[Cure]) -> None:
    """Run a program, and again with each cure that is offered: what it is offered for is gone."""
    offers: dict[Cure, set[Complaint]] = {}
    for complaint, text in complaints(run_to_end(setup).timeline).items():
        if complaint[0] not in ("groups-change-nothing", "threads-never-used", "overrun-timer"):
            cure = cure_in(text)
            if cure is not None:
                offers.setdefault(cure, set()).add(complaint)
    assert offers.keys() == expected, offers
    for cure, ended in offers.items():
        left = complaints(run_to_end(tried(setup, cure)).timeline)
        assert not ended & left.keys(), cure


SENSORS = ("timer_callback", "odom_callback", "scan_callback")


@pytest.mark.parametrize(
    ("lesson", "threads", "call", "cures"),
    [
        ("single-thread", None, None, {(each, 2) for each in SENSORS}),
        pytest.param("shared-group", 2, None, {(each, None) for each in SENSORS}, marks=pytest.mark.slow),
        pytest.param("no-groups-at-all", None, 2.55, {("timer_callback", None)}, marks=pytest.mark.slow),
        pytest.param("reentrant-1-thread", None, 2.55, {("", 2)}, marks=pytest.mark.slow),
        pytest.param("lock-or-group", None, None, {("count_with_lock", None)}, marks=pytest.mark.slow),
    ],
)
def test_each_cure_that_a_lesson_is_offered_ends_what_it_is_offered_for(
    lesson: str, threads: int | None, call: float | None, cures: set[Cure]
) -> None:
    setup = setup_for(find(lesson), threads=threads, speed=None)
    calls = () if call is None else (TimedCall(round(call * SECOND), data=True),)
    check_cures(msgspec.structs.replace(setup, until=16 * SECOND, calls=calls), cures)


def test_a_thread_is_counted_for_every_long_callback_that_would_take_it(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(RIVALS)
    check_cures(program_setup(path, 13.0), {("quick", 3), ("long", 3)})


def test_no_thread_is_counted_for_the_callbacks_of_another_executor(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(TWO_EXECUTORS)
    check_cures(program_setup(path, 13.0), {("quick", 2)})


BESIDE_SHORT = """
import threading
import time
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor


def wait():
    threading.Event().wait()


def quick():
    pass


def short():
    time.sleep(0.02)


rclpy.init()
node = rclpy.create_node("node")
node.create_timer(1.0, wait)
node.create_timer(0.5, quick)
node.create_timer(0.2, short, MutuallyExclusiveCallbackGroup())
executor = MultiThreadedExecutor(2)
executor.add_node(node)
executor.spin()
"""


def test_no_thread_is_counted_for_callbacks_that_take_one_for_moments(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(BESIDE_SHORT)
    cures = {cure_in(each) for each in complaints(run_to_end(program_setup(path, 13.0)).timeline).values()}
    assert ("wait", None) in cures
    assert ("wait", 3) not in cures
