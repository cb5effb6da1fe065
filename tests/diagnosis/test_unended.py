"""Waits for what nothing in a file sets: told of a thread, and of a callback, only if that is sure."""

from pathlib import Path

import pytest

from sim.diagnosis import diagnose
from sim.diagnosis.edits.flags import asked_at, never_completed, never_set, parties_at
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


@pytest.mark.parametrize(
    ("made", "wait", "use", "missing"),
    [
        ("threading.Event()", "wait()", "is_set()", "self.it.set()"),
        ("threading.Condition()", "wait()", "acquire()", "self.it.notify()"),
        ("threading.Condition()", "wait()", "notify_all()", ""),
        ("queue.Queue(5)", "get()", "empty()", "self.it.put()"),
        ("queue.Queue(5)", "get()", "put_nowait(1)", ""),
        ("queue.Queue(5)", "get(True, 1.0)", "empty()", ""),
    ],
)
def test_what_would_end_a_wait_is_missing_only_if_the_file_has_nothing_like_it(
    made: str, wait: str, use: str, missing: str, tmp_path: Path
) -> None:
    path = tmp_path / "node.py"
    path.write_text(
        f"def a(self):\n    self.it = {made}\n    with self.it:\n        self.it.{wait}\n    self.it.{use}\n"
    )
    assert never_set(str(path), 4) == missing


@pytest.mark.parametrize(
    ("made", "use", "completed", "asked"),
    [
        ("Future()", "done()", ("self.it", 2), 0),
        ("rclpy.task.Future()", "add_done_callback(print)", ("self.it", 2), 0),
        ("Future()", "set_result(1)", ("", 0), 0),
        ("Future()", "cancel()", ("", 0), 0),
        ("Future(); give(self.it)", "done()", ("", 0), 0),
        ("None; self.it = self.client.call_async(1)", "done()", ("", 0), 2),
        ("Future()", "done(); self.it = self.client.call_async(1)", ("", 0), 0),
    ],
)
def test_an_awaited_future_is_never_completed_only_if_the_file_makes_it_and_does_nothing_with_it(
    made: str, use: str, completed: tuple[str, int], asked: int, tmp_path: Path
) -> None:
    path = tmp_path / "node.py"
    path.write_text(f"async def a(self):\n    self.it = {made}\n    await self.it\n    self.it.{use}\n")
    assert never_completed(str(path), 3) == completed
    assert asked_at(str(path), 3) == asked


def test_a_barrier_has_the_functions_that_wait_at_it_and_none_of_another(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    made = "import threading\ngate = threading.Barrier(3)\nother = threading.Barrier(2)\n"
    path.write_text(
        f"{made}def a():\n    gate.wait(9.0)\ndef b():\n    gate.wait()\ndef c():\n    other.wait()\n"
    )
    assert parties_at(str(path), 5) == ("gate", 3, ("a", "b"))
    assert parties_at(str(path), 3) == ("", 0, ())


IN_TURN = """
import threading
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

class Order(Node):
    def __init__(self):
        super().__init__("order")
        self.a, self.b, self.c = None, None, None
        self.a = threading.Lock()
        self.b = threading.RLock()
        self.c = threading.Lock()
        own = MutuallyExclusiveCallbackGroup()
        self.create_timer(0.5, self.one)
        self.create_timer(0.7, self.two, callback_group={group})

    def one(self):
        with {first}:
            pass

    def two(self):
        with {second}:
            pass

rclpy.init()
executor = MultiThreadedExecutor({threads})
executor.add_node(Order())
executor.spin()
"""


@pytest.mark.parametrize(
    ("first", "second", "group", "threads", "told"),
    [
        ("self.a, self.b", "self.b, self.a", "own", 2, True),
        ("self.a, self.b:\n          with self.c", "self.c, self.a", "own", 2, True),
        ("self.a, self.b", "self.a, self.b", "own", 2, False),
        ("self.c, self.a, self.b", "self.c, self.b, self.a", "own", 2, False),
        ("self.a, self.b", "self.b, self.a", "None", 2, False),
        ("self.a, self.b", "self.b, self.a", "own", 1, False),
        ("self.a, self.b", "self.b:\n            pass\n        with self.a", "own", 2, False),
    ],
)
def test_locks_in_opposite_orders_are_worth_a_remark_where_callbacks_may_run_at_once(
    first: str, second: str, group: str, threads: int, told: bool, tmp_path: Path
) -> None:
    program = IN_TURN.format(first=first, second=second, group=group, threads=threads)
    timeline = run_program(tmp_path, program, 3.0).timeline
    found = [each for each in diagnose(timeline) if each.rule.id == "locks-in-turn"]
    assert [each.explained(timeline).what.partition(":")[0] for each in found] == (
        [f"one takes {first[:6]} and then {second[:6]}, two first {second[:6]} and then {first[:6]}"] * told
    )
    assert all(each.weight_in(timeline) is Weight.REMARK for each in found)


ASKED = """
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger

class Desk(Node):
    def __init__(self):
        super().__init__("desk")
        self.pending = Future()
        own, another = MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()
        self.create_service(Trigger, "confirm", self.on_confirm, callback_group=own)
        self.client = self.create_client(Trigger, "confirm", callback_group=another)
        self.create_timer({period}, self.press, callback_group={group})
        self.once = self.create_timer(1.0, self.ask, callback_group=another)

    async def on_confirm(self, request, response):
        await self.pending
        return response

    def ask(self):
        self.once.cancel()
        self.client.call_async(Trigger.Request())

    def press(self):
        {press}

rclpy.init()
rclpy.spin(Desk())
"""


@pytest.mark.parametrize(
    ("period", "group", "press", "weight", "clause"),
    [
        (
            60.0,
            "another",
            "pass",
            Weight.PROBLEM,
            ": nothing in node.py completes self.pending, which line 11",
        ),
        (60.0, "another", "self.pending.set_result(1)", Weight.REMARK, "let press complete it"),
        (
            60.0,
            "own",
            "self.pending.set_result(1)",
            Weight.PROBLEM,
            "give on_confirm a callback group of its own",
        ),
        (4.5, "another", "self.pending.set_result(1)", None, ""),
    ],
    ids=["never", "maybe later", "by what its group keeps out", "came"],
)
def test_a_service_that_awaits_in_vain_is_told_and_a_problem_only_if_that_is_sure(
    period: float, group: str, press: str, weight: Weight | None, clause: str, tmp_path: Path
) -> None:
    source = ASKED.format(period=period, group=group, press=press)
    timeline = Timeline()
    timeline.extend(run_program(tmp_path, source, seconds=6).events)
    found = [each for each in diagnose(timeline) if each.rule.id == "reply-awaits-in-vain"]
    assert [each.weight_in(timeline) for each in found] == ([weight] if weight else [])
    for each in found:
        told = each.explained(timeline)
        assert "on_confirm awaits self.pending, which has not come so far, since 1.000 s" in told.what
        assert "/confirm has not answered" in told.what
        assert clause in told.cure
        assert str(told.place) == "node.py:19"
