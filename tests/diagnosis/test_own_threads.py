"""Threads of a program's own that wait for an event: told only if nothing in their file can set it."""

from pathlib import Path

import pytest

from sim.diagnosis import diagnose
from sim.diagnosis.rule import Weight
from sim.trace.timeline import Timeline
from tests.support.engine_runs import run_program

_NODE = """
import threading
import rclpy
from rclpy.node import Node

class Guard(Node):
    def __init__(self):
        super().__init__("guard")
        self.go = threading.Event()
        threading.Thread(target=self.work, daemon=True).start()
        {first}

    def work(self):
        self.go.{wait}
        self.go.clear()

    def tick(self):
        {then}

rclpy.init()
rclpy.spin(Guard())
"""


def told_of(folder: Path, wait: str = "wait()", first: str = "pass", then: str = "pass") -> list[str]:
    run = run_program(folder, _NODE.format(wait=wait, first=first, then=then), seconds=4)
    timeline = Timeline()
    timeline.extend(run.events)
    found = [each for each in diagnose(timeline) if each.rule.id == "thread-waits-for-nobody"]
    assert all(each.weight_in(timeline) is Weight.REMARK for each in found)
    return [f"{told.what} ({told.place})" for told in (each.explained(timeline) for each in found)]


def test_a_thread_that_waits_for_what_nothing_sets_is_told_with_its_line(tmp_path: Path) -> None:
    (told,) = told_of(tmp_path)
    assert told.startswith("the thread Thread-1 (work) waits in Event.wait(), and nothing in ")
    assert told.endswith("node.py calls self.go.set() (node.py:14)")


@pytest.mark.parametrize(
    ("wait", "first", "then"),
    [
        ("wait(9.0)", "pass", "pass"),
        ("wait()", "pass", "self.go.set()"),
        ("wait()", "self.create_timer(9.0, self.go.set)", "pass"),
        ("wait()", "guards.append(self.go)", "pass"),
        ("wait()", "self.go = guards[0]", "pass"),
    ],
    ids=["with a timeout", "set later", "set by a timer", "handed on", "not its own"],
)
def test_of_a_thread_that_may_yet_go_on_nothing_is_said(
    wait: str, first: str, then: str, tmp_path: Path
) -> None:
    before = f"global guards; guards = [threading.Event()]; {first}" if "guards" in first else first
    assert told_of(tmp_path, wait, before, then) == []
