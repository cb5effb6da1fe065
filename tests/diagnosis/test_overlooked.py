"""What a program makes nothing of: a future's result before there is one, and the refusal of a parameter."""

import gc
import weakref
from collections.abc import Callable
from pathlib import Path
from textwrap import dedent, indent
from typing import Any

import pytest

from sim.diagnosis import diagnose
from sim.interfaces import message
from sim.probes.loop_variables import SharedVariables
from sim.ros.node.node import Node
from sim.ros.parameters.parameter import Parameter
from tests.diagnosis.findings import Diagnosed, SetBool, diagnosed, once, spin
from tests.support.engine_runs import run_program
from tests.support.simulation import Simulation

SetParametersResult = message("rcl_interfaces", "SetParametersResult")
Use = Callable[[Node], object]


def told_of(use: Use, *, calls: int = 2) -> Diagnosed:
    """A node that refuses parameters above 2, offers a service, and does something in each tick."""

    def program(_: Simulation) -> None:
        node = Node("n")
        node.declare_parameter("limit", 1.0)
        node.add_on_set_parameters_callback(
            lambda asked: SetParametersResult(successful=asked[0].value <= 2.0, reason="too fast")
        )
        node.create_service(SetBool, "lamp", lambda _, response: response)

        def tick() -> None:
            use(node)

        for number in range(calls):
            once(node, 1.0 + number, tick)
        spin(node, None)

    return diagnosed(program, until=5.0)


def faster(node: Node, value: float = 3.0) -> None:
    node.set_parameters([Parameter("limit", value=value)])


def faster_at_once(node: Node) -> None:
    node.set_parameters_atomically([Parameter("limit", value=3.0)])


def faster_or_not(node: Node) -> bool:
    (result,) = node.set_parameters([Parameter("limit", value=3.0)])
    return bool(result.successful)


@pytest.mark.parametrize("use", [faster, faster_at_once])
def test_a_refused_parameter_is_told_if_the_answer_is_dropped(use: Use) -> None:
    run = told_of(use)
    assert run.problems() == set()
    told = run.explained("answer-overlooked")
    assert told.what == ("tick does not look at what set_parameters() returns: limit was refused: too fast")
    assert told.place is not None
    assert "set_parameters" in Path(told.place.file).read_text().splitlines()[told.place.first_line - 1]


@pytest.mark.parametrize("use", [faster_or_not, lambda node: faster(node, 1.5)], ids=["looks", "not refused"])
def test_an_answer_that_is_looked_at_or_refuses_nothing_is_well(use: Use) -> None:
    assert told_of(use).told() == set()


def early(node: Node) -> object:
    future = node.create_client(SetBool, "lamp").call_async(SetBool.Request())
    return future.result()


def test_a_result_that_is_asked_for_as_soon_as_the_request_is_sent_is_told_with_its_line() -> None:
    run = told_of(early)
    assert run.problems() == set()
    told = run.explained("answer-overlooked")
    assert told.what == "tick asks a future for its result() as soon as the request is sent: that is None"
    assert told.cure.startswith("use the result in a done-callback, by future.add_done_callback(), or await")
    assert told.place is not None
    line = Path(told.place.file).read_text().splitlines()[told.place.first_line - 1]
    assert line.strip() == "return future.result()"


def test_a_result_that_a_later_callback_asks_for_is_well_though_it_may_not_be_there() -> None:
    futures: list[Any] = []

    def poll(node: Node) -> None:
        if futures:
            futures.pop().result()
        futures.append(node.create_client(SetBool, "nobody").call_async(SetBool.Request()))

    assert "answer-overlooked" not in {rule for rule, _ in told_of(poll).told()}


_NODE = """
import functools
import rclpy

rclpy.init()
node = rclpy.create_node("n")
each = node.get_logger().info


def numbered(number):
    return lambda: each(f"{number}")


def add(numbers):
    for number in numbers:
        node.create_timer(0.5, lambda: each(f"{number}"))


def make():
MADE


make()
rclpy.spin(node)
"""


def told_of_lines(made: str, folder: Path) -> list[str]:
    """What is said of a function with these lines that makes timers."""
    run = run_program(folder, _NODE.replace("MADE", indent(dedent(made), "    ")), seconds=2.0)
    return [each.explained(run.timeline).cure for each in diagnose(run.timeline)]


@pytest.mark.parametrize(
    "made",
    [
        "for a in range(2): node.create_timer(0.5, lambda: each(f'{a}'))",
        "[node.create_timer(0.5, lambda: each(f'{a}')) for a in range(2)]",
        "for b in range(2):\n    a = f'{b}'\n    node.create_timer(0.5, lambda: each(a))",
    ],
)
def test_callbacks_of_a_loop_that_share_its_variable_are_told(made: str, tmp_path: Path) -> None:
    bound = "bind it when each is made: lambda a=a: …, or functools.partial"
    assert told_of_lines(made, tmp_path) == [bound]


def test_functions_defined_in_a_loop_share_its_variable_too(tmp_path: Path) -> None:
    made = "for a in range(2):\n    def tick():\n        each(f'{a}')\n    node.create_timer(0.5, tick)"
    assert told_of_lines(made, tmp_path) == ["bind it when each is made: def tick(a=a)"]


@pytest.mark.parametrize(
    "made",
    [
        "for a in range(2): node.create_timer(0.5, lambda a=a: each(f'{a}'))",
        "for a in range(2): node.create_timer(0.5, functools.partial(each, f'{a}'))",
        "for a in range(2): node.create_timer(0.5, numbered(a))",
        "add([1])\nadd([2])",
        "n = 0\nfor a in range(2):\n    n += 1\n    node.create_timer(0.5, lambda a=a: each(f'{a} of {n}'))",
        "for a in (1, 1): node.create_timer(0.5, lambda: each(f'{a}'))",
    ],
    ids=["default", "partial", "factory", "two loops of one", "counter", "same value"],
)
def test_callbacks_of_a_loop_with_values_of_their_own_are_well(made: str, tmp_path: Path) -> None:
    assert told_of_lines(made, tmp_path) == []


_COROUTINES = """
import rclpy

rclpy.init()
node = rclpy.create_node("n")


async def fetch():
    node.get_logger().info("fetched")


async def whole():
    await fetch()


def drop():
    fetch()


def start():
    node.executor.create_task(fetch())


node.create_timer(0.5, CALLBACK)
rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ("callback", "cures"),
    [
        ("drop", ["put await before fetch(), in an async def drop"]),
        ("fetch", []),
        ("whole", []),
        ("start", []),
    ],
)
def test_a_coroutine_that_a_callback_drops_is_told(callback: str, cures: list[str], tmp_path: Path) -> None:
    run = run_program(tmp_path, _COROUTINES.replace("CALLBACK", callback), seconds=2.0)
    assert [each.explained(run.timeline).cure for each in diagnose(run.timeline)] == cures


_GOALS = """
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, GoalResponse

def execute(goal):
    goal.succeed()
    return Fibonacci.Result()

def accepted(future):
    goal = future.result()
    if goal.accepted or BLINDLY:
        goal.get_result_async()

rclpy.init()
node = rclpy.create_node("n")
server = ActionServer(node, Fibonacci, "fib", execute, goal_callback=lambda _: GoalResponse.REJECT)
client = ActionClient(node, Fibonacci, "fib")
client.wait_for_server()
client.send_goal_async(Fibonacci.Goal()).add_done_callback(accepted)
rclpy.spin(node)
"""


@pytest.mark.parametrize("blindly", [True, False])
def test_the_result_of_a_rejected_goal_is_told_where_it_is_asked_for(blindly: bool, tmp_path: Path) -> None:
    run = run_program(tmp_path, _GOALS.replace("BLINDLY", str(blindly)), seconds=2.0)
    told = [each.explained(run.timeline) for each in diagnose(run.timeline)]
    lines = ["look at goal_handle.accepted first, and return if it is False"]
    assert [each.cure for each in told] == (lines if blindly else [])


def test_what_a_function_of_a_loop_closes_over_is_not_kept_alive() -> None:
    class Held:
        pass

    shared, place = SharedVariables(), (__file__, 1)

    def made(held: Held) -> None:
        shared.of(lambda: held, place)

    held = Held()
    gone = weakref.ref(held)
    made(held)
    del held
    gc.collect()
    assert gone() is None


_LIFECYCLE = """
import rclpy
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String

class Talker(LifecycleNode):
    def on_configure(self, state):
        self.words = self.create_lifecycle_publisher(String, "words", 10)
        self.create_timer(0.5, lambda: self.words.publish(String()))
        return super().on_configure(state)

    def on_activate(self, state):
        {ends}

rclpy.init()
talker = Talker("talker")
talker.trigger_configure()
{then}
rclpy.spin(talker)
"""
_KEPT = "return super().on_activate(state)"
_FORGOTTEN = "return super().on_configure(state)"


@pytest.mark.parametrize(
    ("ends", "then", "cure"),
    [
        (_KEPT, "", "activate the node: trigger_activate() once trigger_configure() has succeeded"),
        (
            _FORGOTTEN,
            "talker.trigger_activate()",
            f"end on_activate with: {_KEPT}, which activates the publishers",
        ),
        (_KEPT, "talker.trigger_activate()", None),
        (_KEPT, "talker.create_timer(2.2, talker.trigger_activate)", None),
    ],
)
def test_a_lifecycle_publisher_that_is_never_active_is_told_of_with_its_line(
    ends: str, then: str, cure: str | None, tmp_path: Path
) -> None:
    run = run_program(tmp_path, _LIFECYCLE.format(ends=ends, then=then), seconds=3.0)
    told = [each.explained(run.timeline) for each in diagnose(run.timeline) if each.rule.id == "slip"]
    assert [(each.cure, each.place and each.place.first_line) for each in told] == (
        [(cure, 9)] if cure else []
    )
