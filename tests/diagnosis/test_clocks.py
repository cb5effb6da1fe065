"""Timers that are never due, or always, by a clock that does not go, or a period of zero; and kept times."""

from pathlib import Path

import pytest

from sim.diagnosis import Weight, diagnose
from sim.diagnosis.edits.clocks import follow_jumps, kept_at
from sim.diagnosis.edits.code_edit import CodeEdit
from sim.quantities.nanoseconds import SECOND
from tests.support.engine_runs import run_program

FOLLOWER = """
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock as Time

rclpy.init()
node = Node("follower", parameter_overrides=[Parameter("use_sim_time", value=True)])
node.create_timer(0.5, lambda: None)
{more}
rclpy.spin(node)
"""
TICKS = """
publisher = node.create_publisher(Time, "/clock", 10)
node.create_timer(0.2, lambda: publisher.publish(Time()), clock=Clock(clock_type=ClockType.STEADY_TIME))
"""


@pytest.mark.parametrize(("more", "until", "told"), [("", 2.0, True), ("", 0.9, False), (TICKS, 2.0, False)])
def test_timers_that_follow_a_clock_that_is_never_sent_are_told(
    more: str, until: float, told: bool, tmp_path: Path
) -> None:
    found = diagnose(run_program(tmp_path, FOLLOWER.replace("{more}", more), until).timeline)
    assert ("clock-never-starts" in {each.rule.id for each in found}) is told


SLEEPER = """
import threading
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter

rclpy.init()
node = Node("sleeper", parameter_overrides=[Parameter("use_sim_time", value=True)])
{before}
{sleep}
"""
IN_MAIN = "threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()"
IN_CALLBACK = (
    "sleep = lambda: {sleep}\nnode.create_timer(0.5, sleep, clock=Clock(clock_type=ClockType.STEADY_TIME))"
)
SLEEP = "node.get_clock().sleep_for(Duration(seconds=1))"
OF_OTHER = "Clock().sleep_for(Duration(seconds=1))"


@pytest.mark.parametrize(
    ("before", "sleep", "place"),
    [
        (IN_MAIN, SLEEP, "node.py:12"),
        (IN_CALLBACK.format(sleep=SLEEP), "rclpy.spin(node)", "node.py:11"),
        (IN_MAIN, OF_OTHER, ""),
        (IN_CALLBACK.format(sleep=OF_OTHER), "rclpy.spin(node)", ""),
    ],
    ids=["main", "callback", "another clock in main", "another clock"],
)
def test_a_sleep_by_a_clock_that_is_never_sent_is_told_with_its_line(
    before: str, sleep: str, place: str, tmp_path: Path
) -> None:
    timeline = run_program(tmp_path, SLEEPER.format(before=before, sleep=sleep), 3.0).timeline
    found = [each for each in diagnose(timeline) if each.rule.id == "clock-never-starts"]
    told = [each.explained(timeline) for each in found]
    assert [str(each.place) for each in told] == ([place] if place else [])
    for each in told:
        line = place.rpartition(":")[2]
        assert each.what.startswith(
            f"the sleep of line {line} does not end: use_sim_time is true, and nothing"
        )


def test_a_timer_of_period_zero_that_is_called_once_is_no_problem(tmp_path: Path) -> None:
    text = """
import rclpy

rclpy.init()
node = rclpy.create_node("later")
timer = node.create_timer(0.0, lambda: timer.cancel())
rclpy.spin(node)
"""
    run = run_program(tmp_path, text, 2.0)
    assert not [each for each in diagnose(run.timeline) if each.rule.weight is Weight.PROBLEM]


GUARDED = """
import rclpy
from rclpy.node import Node


class Looper(Node):
    def __init__(self):
        super().__init__("looper")
        self.count = 0
        self.guard = self.create_guard_condition(self.go_on)
        self.create_timer(1.0, self.guard.trigger)

    def go_on(self):
        self.count += 1
        if self.count < MOST:
            self.AGAIN()


rclpy.init()
rclpy.spin(Looper())
"""


@pytest.mark.parametrize(
    ("most", "again", "told"),
    [
        ("1e9", "guard.trigger", True),
        ("2000", "guard.trigger", False),
        ("1e9", "get_logger", False),
    ],
    ids=["without end", "with an end", "not again"],
)
def test_a_guard_condition_that_triggers_itself_without_end_is_told_with_the_line(
    most: str, again: str, told: bool, tmp_path: Path
) -> None:
    source = GUARDED.replace("MOST", most).replace("AGAIN", again)
    timeline = run_program(tmp_path, source, 3.0).timeline
    found = diagnose(timeline)
    assert [each.rule.id for each in found] == ["triggers-itself"] * told
    for each in found:
        explained = each.explained(timeline)
        assert str(explained.place) == "node.py:16"
        assert each.at == SECOND
        assert explained.for_ever
        (cure,) = explained.remedies
        assert cure.edit is not None
        assert "guard.trigger()" not in (cure.edit.applied(source) or "guard.trigger()")


LOOKS = "if self.done_at is None or now >= self.done_at:"


@pytest.mark.parametrize(
    ("change", "into", "until", "told"),
    [
        ("look", "look", 2.5, False),
        ("look", "look", 2.7, True),
        (LOOKS, "if True:", 4.0, False),
        (LOOKS, f"{LOOKS[:-1]} or now < self.done_at - Duration(seconds=1.5):", 4.0, False),
        ("self.ticks < 20", "self.ticks < 99", 4.0, False),
    ],
    ids=["too early", "kept", "renewed", "found out", "never set back"],
)  # fmt: skip
def test_a_time_is_told_that_a_node_keeps_though_its_clock_is_set_back(
    change: str, into: str, until: float, told: bool, tmp_path: Path
) -> None:
    text = (Path(__file__).parent / "beginners" / "time_of_before.py").read_text()
    found = diagnose(run_program(tmp_path, text.replace(change, into), until).timeline)
    assert ("times-kept" in {each.rule.id for each in found}) is told


def test_a_time_that_is_set_back_with_the_clock_is_not_told(tmp_path: Path) -> None:
    path = Path(__file__).parent / "beginners" / "time_of_before.py"
    text = path.read_text()
    edit = CodeEdit(str(path), "", follow_jumps, (kept_at(str(path), "done_at"), "done_at"))
    changed = edit.applied(text)
    assert changed is not None
    assert not diagnose(run_program(tmp_path, changed, 4.0).timeline)
