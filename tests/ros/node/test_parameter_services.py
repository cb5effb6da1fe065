"""The services by which others reach a node's parameters, and what the trace shows of them."""

from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.interfaces import rcl_interfaces as rcl
from sim.ros.logging.logger import LoggingSeverity, get_logger
from sim.ros.node.node import Node
from sim.ros.parameters.parameter import Parameter
from sim.ros.scheduling.executors import MultiThreadedExecutor, SingleThreadedExecutor
from sim.trace.events import EntityAppeared, EntityReady, GroupAppeared, Published, ServiceReplied
from sim.trace.model import Window
from tests.support.simulation import Simulation, Trace, simulate

Empty = service("std_srvs", "Empty")
SetBool = service("std_srvs", "SetBool")


def asked(node: Node, srv_type: Any, name: str, request: Any) -> Any:
    """Call a service of ``node`` from another node and spin both until the answer is there."""
    caller = Node("caller")
    client = caller.create_client(srv_type, name)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(caller)
    future = client.call_async(request)
    executor.spin_until_future_complete(future, timeout_sec=1.0)
    executor.remove_node(node)
    caller.destroy_node()
    return future.result()


def test_parameters_are_read_and_set_through_services() -> None:
    def program(_: Simulation) -> None:
        node = Node("n", namespace="arm")
        node.declare_parameter("speed", 1.0, rcl.ParameterDescriptor(description="m/s"))

        def ask(srv_type: Any, name: str, **fields: Any) -> Any:
            return asked(node, srv_type, f"/arm/n/{name}", srv_type.Request(**fields))

        values = ask(rcl.GetParameters, "get_parameters", names=["speed"]).values
        assert [(each.type, each.double_value) for each in values] == [(3, 1.0)]
        assert list(ask(rcl.GetParameterTypes, "get_parameter_types", names=["speed"]).types) == [3]
        assert ask(rcl.GetParameters, "get_parameters", names=["speed", "x"]).values == []
        assert list(ask(rcl.GetParameterTypes, "get_parameter_types", names=["speed", "x"]).types) == []
        assert "speed" in ask(rcl.ListParameters, "list_parameters").result.names
        (described,) = ask(rcl.DescribeParameters, "describe_parameters", names=["speed"]).descriptors
        assert (described.name, described.type, described.description) == ("speed", 3, "m/s")
        assert ask(rcl.DescribeParameters, "describe_parameters", names=["x"]).descriptors == []

        wanted = [Parameter("speed", value=each).to_parameter_msg() for each in (2.0, "fast")]
        set_, refused = ask(rcl.SetParameters, "set_parameters", parameters=wanted).results
        assert set_.successful
        assert refused.reason == "Wrong parameter type, expected 'Type.DOUBLE' got 'Type.STRING'"
        missing = [Parameter("x", value=1).to_parameter_msg()]
        result = ask(rcl.SetParametersAtomically, "set_parameters_atomically", parameters=missing).result
        assert not result.successful
        assert "undeclared" in result.reason
        assert node.get_parameter("speed").value == 2.0

    simulate(program)


def test_a_node_may_do_without_its_services() -> None:
    def program(_: Simulation) -> None:
        names = [each.srv_name for each in Node("n").services]
        assert names[:2] == ["/n/describe_parameters", "/n/get_parameters"]
        assert names[-1] == "/n/get_type_description"
        assert [each.srv_name for each in Node("m", start_parameter_services=False).services] == [
            "/m/get_type_description"
        ]
        off = Parameter("start_type_description_service", value=False)
        quiet = Node("q", start_parameter_services=False, parameter_overrides=[off])
        assert list(quiet.services) == []

    simulate(program)


def test_the_trace_shows_nothing_of_hidden_services_but_the_call_of_one() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        node.declare_parameter("a", 1)
        node.create_service(Empty, "seen", lambda _, response: response)
        assert asked(node, Empty, "seen", Empty.Request()) is not None
        assert asked(node, rcl.ListParameters, "/n/list_parameters", rcl.ListParameters.Request()) is not None

    trace = simulate(program)
    shown = [each.name for each in trace.of(EntityAppeared)]
    assert shown == ["/seen", "/seen", "/n/list_parameters"]  # the service, and the two clients
    assert [each.entity for each in trace.of(EntityAppeared)] == [1, 2, 3]
    assert len(trace.of(GroupAppeared)) == 3
    assert {each.entity for each in trace.of(EntityReady)} == {1, 2, 3}
    assert {each.name for each in trace.calls()} == {trace.names[1], "/seen", "/n/list_parameters"}
    assert [each.service for each in trace.of(ServiceReplied)] == ["/seen", "/n/list_parameters"]
    assert trace.of(Published) == []


def test_a_node_without_entities_of_its_own_shows_no_group() -> None:
    assert simulate(lambda _: Node("n")).of(GroupAppeared) == []


@pytest.mark.parametrize("threads", [1, 3])
def test_parameters_cannot_be_set_while_the_default_group_is_held(threads: int) -> None:
    """Hidden services live in the default group, so a slow callback there makes ``ros2 param set`` wait."""
    times: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.declare_parameter("a", 1)

        def slow() -> None:
            node.destroy_timer(timer)
            simulation.sleep(5.0)

        def note(parameters: list[Parameter[Any]]) -> Any:
            times.append(simulation.now)
            return rcl.SetParametersResult(successful=True)

        timer = node.create_timer(1.0, slow)
        node.add_on_set_parameters_callback(note)
        outside = simulation.outside_node()
        client = outside.create_client(rcl.SetParameters, "/n/set_parameters")
        wanted = [Parameter("a", value=2).to_parameter_msg()]
        simulation.at(2.0, lambda: client.call_async(rcl.SetParameters.Request(parameters=wanted)))
        executor = SingleThreadedExecutor() if threads == 1 else MultiThreadedExecutor(threads)
        executor.add_node(node)
        executor.spin()

    simulate(program, until=10.0)
    assert times == [6.0]


def test_what_a_callback_does_inside_a_hidden_service_is_shown_without_a_callback() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.declare_parameter("a", 1)

        def refuse(parameters: list[Parameter[Any]]) -> Any:
            node.get_logger().info(f"asked for {parameters[0].value}")
            raise ValueError("broken")

        node.add_on_set_parameters_callback(refuse)
        request = rcl.SetParameters.Request(parameters=[Parameter("a", value=2).to_parameter_msg()])
        with pytest.raises(ValueError, match=r"^broken$"):
            asked(node, rcl.SetParameters, "/n/set_parameters", request)

    trace = simulate(program)
    assert trace.said() == ["asked for 2"]
    assert any("ValueError: broken" in mark.text for mark in trace.timeline().marks(Window(0, 10**9)))


def test_parameter_events_tell_a_listener_what_was_set() -> None:
    heard: list[Any] = []

    def program(_: Simulation) -> None:
        node = Node("n", allow_undeclared_parameters=True)
        listener = Node("listener")
        event = message("rcl_interfaces", "ParameterEvent")
        listener.create_subscription(event, "/parameter_events", heard.append, 10)
        node.declare_parameter("a", 1)
        node.set_parameters([Parameter("a", value=2)])
        node.set_parameters([Parameter("b", value=3)])
        node.set_parameters([Parameter("b")])
        for _each in range(4):
            rclpy.spin_once(listener, timeout_sec=1.0)

    trace = simulate(program)
    kinds = [
        [
            [each.name for each in part]
            for part in (one.new_parameters, one.changed_parameters, one.deleted_parameters)
        ]
        for one in heard
    ]
    assert kinds == [[["a"], [], []], [[], ["a"], []], [["b"], [], []], [[], [], ["b"]]]
    assert heard[1].node == "/n"
    assert heard[1].changed_parameters[0].value.integer_value == 2
    assert len(trace.of(Published)) == 4


def test_a_node_that_dies_takes_its_services_along() -> None:
    def program(_: Simulation) -> None:
        node, caller = Node("n"), Node("caller")
        client = caller.create_client(rcl.GetParameters, "/n/get_parameters")
        assert client.service_is_ready()
        node.destroy_node()
        assert not client.service_is_ready()

    simulate(program)


def test_logger_levels_are_read_and_set_through_services() -> None:
    def program(_: Simulation) -> None:
        node = Node("n", enable_logger_service=True)
        levels = [rcl.LoggerLevel(name="n", level=10), rcl.LoggerLevel(name="n", level=11)]
        request = rcl.SetLoggerLevels.Request(levels=levels)
        set_, refused = asked(node, rcl.SetLoggerLevels, "/n/set_logger_levels", request).results
        assert set_.successful
        assert refused.reason == "Failed reason: Invalid logger level."
        assert get_logger("n").get_effective_level() == LoggingSeverity.DEBUG
        request = rcl.GetLoggerLevels.Request(names=["n", "other"])
        found = asked(node, rcl.GetLoggerLevels, "/n/get_logger_levels", request).levels
        assert [(each.name, each.level) for each in found] == [("n", 10), ("other", 0)]

    simulate(program)


def test_runs_with_hidden_services_are_the_same_each_time() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(0.1, lambda: node.set_parameters([Parameter("use_sim_time", value=False)]))
        simulation.publisher_at_rate("t", 0.05, until=0.5)
        node.create_subscription(message("std_msgs", "Int32"), "t", lambda _: None, 10)
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()

    def run() -> Trace:
        return simulate(program, until=1.0)

    assert run().events == run().events
