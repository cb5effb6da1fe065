"""Reading and setting the parameters of another node through its services."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import rcl_interfaces as rcl
from sim.ros.node.node import Node
from sim.ros.node.parameter_client import AsyncParameterClient
from sim.ros.parameters.parameter import Parameter
from sim.ros.scheduling.executors import SingleThreadedExecutor
from sim.ros.scheduling.task import Future
from tests.support.simulation import Simulation, simulate

Ask = Callable[[Future[Any]], Any]
Check = Callable[[AsyncParameterClient, Node, Ask], None]


def with_client(check: Check) -> None:
    """Run ``check`` with a client of the node ``/arm/target``, and what waits for a reply."""

    def program(_: Simulation) -> None:
        node, target = Node("asking"), Node("target", namespace="arm", allow_undeclared_parameters=True)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.add_node(target)

        def reply(future: Future[Any]) -> Any:
            executor.spin_until_future_complete(future, timeout_sec=1.0)
            return future.result()

        check(AsyncParameterClient(node, "/arm/target"), target, reply)

    simulate(program)


def test_values_types_and_descriptors_are_read() -> None:
    def check(client: AsyncParameterClient, target: Node, ask: Ask) -> None:
        target.declare_parameter("speed", 1.5, rcl.ParameterDescriptor(description="m/s"))
        target.declare_parameter("steps", [1, 2])
        values = ask(client.get_parameters(["speed", "steps"])).values
        assert values[0].double_value == 1.5
        assert list(values[1].integer_array_value) == [1, 2]
        assert list(ask(client.get_parameter_types(["speed", "steps"])).types) == [3, 7]
        (described,) = ask(client.describe_parameters(["speed"])).descriptors
        assert described.description == "m/s"

    with_client(check)


def test_names_are_listed_by_prefix_and_depth() -> None:
    def check(client: AsyncParameterClient, target: Node, ask: Ask) -> None:
        target.declare_parameter("a.b.c", 1)
        target.declare_parameter("a.d", 1)
        assert set(ask(client.list_parameters()).result.names) >= {"a.b.c", "a.d", "use_sim_time"}
        assert ask(client.list_parameters(prefixes=["a"])).result.names == ["a.b.c", "a.d"]
        assert ask(client.list_parameters(["a"], depth=1)).result.names == ["a.d"]

    with_client(check)


def test_parameters_and_their_messages_can_be_set() -> None:
    def check(client: AsyncParameterClient, target: Node, ask: Ask) -> None:
        wanted = [Parameter("a", value=1), Parameter("b", value="x").to_parameter_msg()]
        assert [each.successful for each in ask(client.set_parameters(wanted)).results] == [True, True]
        assert ask(client.set_parameters_atomically([Parameter("a", value=2)])).result.successful
        assert [each.value for each in target.get_parameters(["a", "b"])] == [2, "x"]

    with_client(check)


def test_only_parameters_of_no_fixed_type_can_be_deleted() -> None:
    def check(client: AsyncParameterClient, target: Node, ask: Ask) -> None:
        target.declare_parameter("fixed", 1)
        target.set_parameters([Parameter("loose", value=1)])
        loose, fixed = ask(client.delete_parameters(["loose", "fixed"])).results
        assert loose.successful
        assert fixed.reason == "Static parameter cannot be undeclared"
        assert not target.has_parameter("loose")

    with_client(check)


def test_one_name_without_a_value_empties_the_whole_answer() -> None:
    def check(client: AsyncParameterClient, target: Node, ask: Ask) -> None:
        target.declare_parameter("known", 1)
        target.declare_parameter("typed", Parameter.Type.STRING)
        assert ask(client.get_parameters(["known", "typed"])).values == []
        assert ask(client.describe_parameters(["typed"])).descriptors[0].type == 4

    with_client(check)


def test_a_callback_gets_the_future_of_its_reply() -> None:
    seen: list[Any] = []

    def check(client: AsyncParameterClient, target: Node, ask: Ask) -> None:
        future = client.get_parameters(["use_sim_time"], callback=seen.append)
        ask(future)
        for _ in range(3):
            assert target.executor is not None
            target.executor.spin_once(timeout_sec=0.0)
        assert seen == [future]

    with_client(check)


FILE = """
/arm/target:
  ros__parameters: {count: 3, name: x}
/**:
  ros__parameters: {everywhere: true}
"""


@pytest.mark.parametrize(("use_wildcard", "names"), [(False, 2), (True, 3)])
def test_a_file_is_loaded_with_or_without_what_counts_for_all(
    tmp_path: Path, use_wildcard: bool, names: int
) -> None:
    path = tmp_path / "parameters.yaml"
    path.write_text(FILE)

    def check(client: AsyncParameterClient, target: Node, ask: Ask) -> None:
        assert len(ask(client.load_parameter_file(str(path), use_wildcard)).results) == names
        assert target.get_parameter("count").value == 3
        assert ask(client.load_parameter_file_atomically(str(path), use_wildcard)).result.successful
        assert target.has_parameter("everywhere") is use_wildcard

    with_client(check)


def test_services_are_waited_for_in_steps_of_a_quarter_second() -> None:
    def program(simulation: Simulation) -> None:
        client = AsyncParameterClient(Node("asking"), "target")
        assert not client.wait_for_services(timeout_sec=0.3)
        assert simulation.now == 0.5
        simulation.at(2.1, lambda: Node("target"))
        assert client.wait_for_services()
        assert simulation.now == 2.25
        rclpy.shutdown()

    simulate(program)
