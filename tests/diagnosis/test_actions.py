"""The rules on the goals of actions: accepted and never executed, or going on after their cancel."""

from pathlib import Path

import pytest

from sim.diagnosis import Explanation, diagnose
from sim.diagnosis.edits.actions import end_if_cancelled
from sim.diagnosis.edits.code_edit import diff
from tests.diagnosis.edits.edited_source import changed
from tests.support.engine_runs import run_program

PROGRAM = """
import time
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.executors import MultiThreadedExecutor

def execute(goal):
    for each in range(8):
        LOOK
        time.sleep(0.5)
    goal.succeed()
    return Fibonacci.Result()

def ask():
    timer.cancel()
    client.send_goal_async(Fibonacci.Goal()).add_done_callback(accepted)

def accepted(future):
    time.sleep(WAIT)
    future.result().cancel_goal_async()

rclpy.init()
node = rclpy.create_node("node")
server = ActionServer(
    node, Fibonacci, "fib", execute, cancel_callback=lambda goal: CancelResponse.ACCEPT
)
client = ActionClient(node, Fibonacci, "fib")
timer = node.create_timer(0.5, ask)
executor = MultiThreadedExecutor(3)
executor.add_node(node)
executor.spin()
"""


def told(
    folder: Path, look: str = "pass", wait: float = 1.0, seconds: float = 6.0, program: str = PROGRAM
) -> list[Explanation]:
    text = program.replace("LOOK", look).replace("WAIT", str(wait))
    timeline = run_program(folder, text, seconds=seconds).timeline
    found = [each for each in diagnose(timeline) if each.rule.id in ("cancel-ignored", "endless-wait")]
    assert {each.rule.id for each in found} <= {"cancel-ignored"}
    return [each.explained(timeline) for each in found]


def test_a_goal_that_goes_on_after_its_cancel_is_told_with_the_line_and_an_edit(tmp_path: Path) -> None:
    (found,) = told(tmp_path)
    assert found.what == (
        "execute went on for 3.0 s after the cancel of its goal was accepted, without a look at "
        "is_cancel_requested in the first 2.0 s"
    )
    assert found.place is not None
    assert found.place.first_line == 11
    (remedy,) = found.remedies
    assert remedy.edit is not None
    text = PROGRAM.replace("LOOK", "pass")
    edited = remedy.edit.applied(text) or ""
    assert diff("node.py", text, edited).splitlines()[4:-1] == [
        "+        if goal.is_cancel_requested:",
        "+            goal.canceled()",
        "+            return Fibonacci.Result()",
    ]
    after = diagnose(run_program(tmp_path, edited, seconds=6.0).timeline)
    assert "cancel-ignored" not in {each.rule.id for each in after}


def test_a_goal_that_still_goes_on_is_told_already(tmp_path: Path) -> None:
    (found,) = told(tmp_path, seconds=4.0)
    assert found.what.startswith("execute has gone on for 2.5 s")


@pytest.mark.parametrize("look", ["goal.is_cancel_requested", "goal.status == 3"])
def test_a_callback_that_looks_is_not_told(tmp_path: Path, look: str) -> None:
    assert told(tmp_path, look) == []


def test_a_callback_that_looked_only_before_the_cancel_is_told(tmp_path: Path) -> None:
    assert len(told(tmp_path, "each or goal.is_cancel_requested")) == 1


@pytest.mark.parametrize(("seconds", "times"), [(4.9, 0), (5.1, 1)])
def test_a_goal_is_expected_to_look_from_its_execution_on(tmp_path: Path, seconds: float, times: int) -> None:
    late = """
timers = []
def put_off(goal):
    def begin():
        timers[0].cancel()
        goal.execute()
    timers.append(node.create_timer(2.5, begin))
server.register_handle_accepted_callback(put_off)
client ="""
    assert len(told(tmp_path, wait=0.1, seconds=seconds, program=PROGRAM.replace("client =", late))) == times


def test_a_goal_that_ends_soon_after_its_cancel_is_not_told(tmp_path: Path) -> None:
    assert told(tmp_path, wait=2.5) == []


def test_a_goal_whose_cancel_comes_after_its_end_is_not_told(tmp_path: Path) -> None:
    assert told(tmp_path, wait=4.5, seconds=9.0) == []


ACCEPTED = """
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import MultiThreadedExecutor

def execute(goal):
    goal.succeed()
    return Fibonacci.Result()

def ask():
    timer.cancel()
    client.send_goal_async(Fibonacci.Goal()).add_done_callback(accepted)

def accepted(future):
    future.result().get_result_async()

goals = []
rclpy.init()
node = rclpy.create_node("node")
server = ActionServer(node, Fibonacci, "fib", execute, handle_accepted_callback=goals.append)
client = ActionClient(node, Fibonacci, "fib")
timer = node.create_timer(0.5, ask)
rclpy.spin(node)
"""


def test_a_goal_that_nobody_executes_is_told_and_nothing_of_groups_that_nobody_made(tmp_path: Path) -> None:
    timeline = run_program(tmp_path, ACCEPTED, seconds=4.0).timeline
    (found,) = diagnose(timeline)
    said = found.explained(timeline)
    assert said.what == (
        "a goal of /fib was accepted, and execute has never been called: its result has been waited for "
        "for 3.5 s"
    )
    assert said.place is not None
    assert said.place.first_line == 21
    (remedy,) = said.remedies
    assert remedy.edit is not None
    edited = remedy.edit.applied(ACCEPTED) or ""
    assert edited == ACCEPTED.replace(", handle_accepted_callback=goals.append", "")
    after = diagnose(run_program(tmp_path, edited, seconds=4.0).timeline)
    assert "goal-never-executed" not in {each.rule.id for each in after}


@pytest.mark.parametrize(
    ("program", "seconds"),
    [
        (ACCEPTED, 3.0),
        (ACCEPTED.replace("=goals.append", "=lambda goal: goal.execute()"), 4.0),
        (ACCEPTED.replace("get_result_async()", "get_result_async()\n    time.sleep(9)"), 4.0),
    ],
    ids=["not for long", "executed", "the executor is kept"],
)
def test_a_goal_that_may_still_be_executed_is_not_told(tmp_path: Path, program: str, seconds: float) -> None:
    timeline = run_program(tmp_path, f"import time{program}", seconds=seconds).timeline
    assert "goal-never-executed" not in {each.rule.id for each in diagnose(timeline)}


@pytest.mark.parametrize("executor", ["", ", MultiThreadedExecutor(2)"])
def test_an_execute_callback_that_returns_nothing_is_told_with_its_line_and_an_edit(
    tmp_path: Path, executor: str
) -> None:
    right = ACCEPTED.replace(", handle_accepted_callback=goals.append", "")
    right = right.replace("spin(node)", f"spin(node{executor})")
    program = right.replace("    return Fibonacci.Result()\n", "")
    (found,) = diagnose(timeline := run_program(tmp_path, program, seconds=3.0).timeline)
    said = found.explained(timeline)
    assert said.what.startswith("execute returned no result: the program raised AssertionError: ")
    assert said.cure == "end execute with: return Fibonacci.Result()"
    assert said.place is not None
    assert said.place.first_line == 7
    (remedy,) = said.remedies
    assert remedy.edit is not None
    assert remedy.edit.applied(program) == right
    assert diagnose(run_program(tmp_path, right, seconds=3.0).timeline) == ()


@pytest.mark.parametrize(
    ("execute", "loops"),
    [
        ("def execute(goal):\n    for a in b:\n        for c in d:\n            work()  # here", 1),
        ("def execute(goal):\n    for a in b:\n        work()  # here\n        goal.is_cancel_requested", 0),
        ("def execute(goal, more):\n    for a in b:\n        work()  # here", 0),
        ("def execute(goal):\n    work()  # here", 0),
    ],
    ids=["two loops", "asks already", "other parameters", "no loop"],
)
def test_the_innermost_loop_of_a_callback_that_does_not_ask_yet_is_edited(execute: str, loops: int) -> None:
    lines = changed(
        f"server = ActionServer(node, Turn, 'turn', execute)\n{execute}\n", end_if_cancelled, ("", 1)
    )
    expected = ["if goal.is_cancel_requested:", "    goal.canceled()", "    return Turn.Result()"]
    assert lines == ([f"+            {each}" for each in expected] if loops else None)
