"""What a node is, has, and refuses."""

import importlib
from collections.abc import Callable
from typing import Any
from unittest.mock import Mock

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.ros.context.context import Context
from sim.ros.entities.publisher import Publisher
from sim.ros.exceptions import NotInitializedException, RCLError
from sim.ros.node.node import Node
from sim.ros.time.clock_type import ClockType
from tests.support.simulation import Simulation, simulate

Int32: Any = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")


def with_node(check: Callable[[Any], object]) -> None:
    """Run ``check`` with the node ``/ns/n``."""
    simulate(lambda _: check(Node("n", namespace="ns")))


def test_a_nodes_clock_and_logger_are_its_own() -> None:
    def check(node: Node) -> None:
        assert node.get_clock().clock_type is ClockType.ROS_TIME
        assert node.get_logger().name == "ns.n"
        with pytest.raises(AttributeError):
            node.handle = "garbage"

    with_node(check)


def test_a_node_needs_a_context_that_has_begun() -> None:
    def program(_: Simulation) -> None:
        with pytest.raises(NotInitializedException):
            Node("n", context=Context())

    simulate(program)


def test_a_node_joins_any_executor_that_it_is_given() -> None:
    def check(node: Any) -> None:
        first, second = Mock(), Mock()
        assert node.executor is None
        node.executor = first
        first.add_node.assert_called_once_with(node)
        node.executor = second
        first.remove_node.assert_called_once_with(node)
        second.remove_node.assert_not_called()
        assert node.executor is second
        node.executor = None
        assert node.executor is None

    with_node(check)


def test_a_destroyed_node_has_nothing_left() -> None:
    def check(node: Node) -> None:
        timer, client = node.create_timer(1.0, None), node.create_client(SetBool, "s")
        guard = node.create_guard_condition(None)
        subscription = node.create_subscription(Int32, "t", lambda _: None, 1)
        node.create_publisher(Int32, "t", 1)
        node.create_service(SetBool, "s", lambda _, response: response)
        assert list(node.timers) == [timer]
        assert list(node.clients) == [client]
        assert list(node.guards) == [guard]
        assert subscription in node.subscriptions
        for _ in range(2):
            node.destroy_node()
            for kind in ("publishers", "subscriptions", "timers", "clients", "services", "guards"):
                assert list(getattr(node, kind)) == [], kind

    with_node(check)


def test_only_what_is_the_nodes_can_be_destroyed_and_once() -> None:
    def check(node: Node) -> None:
        other = Node("other")
        for make, destroy in (
            (lambda: node.create_timer(1.0, None), "destroy_timer"),
            (lambda: node.create_client(SetBool, "s"), "destroy_client"),
            (lambda: node.create_publisher(Int32, "t", 1), "destroy_publisher"),
            (lambda: node.create_subscription(Int32, "t", lambda _: None, 1), "destroy_subscription"),
            (lambda: node.create_service(SetBool, "s", lambda _, response: response), "destroy_service"),
            (lambda: node.create_guard_condition(None), "destroy_guard_condition"),
        ):
            entity = make()
            assert not getattr(other, destroy)(entity)
            assert getattr(node, destroy)(entity)
            assert not getattr(node, destroy)(entity)

    with_node(check)


@pytest.mark.parametrize(
    ("make", "error", "text"),
    [
        (lambda node: node.create_publisher(Int32, "t"), TypeError, "qos_profile"),
        (lambda node: node.create_publisher(Int32, "t", -1), ValueError, "greater than or equal to zero"),
        (lambda node: node.create_publisher(Int32, "t", "1"), TypeError, "Expected QoSProfile or int"),
        (lambda node: node.create_publisher(int, "t", 1), AttributeError, "_TYPE_SUPPORT"),
        (lambda node: node.create_publisher(SetBool, "t", 1), RuntimeError, "is not valid"),
        (lambda node: node.create_subscription(Int32, "t", print, -1), ValueError, "greater than or equal"),
        (lambda node: node.create_subscription(SetBool, "t", print, 1), RuntimeError, "is not valid"),
        (lambda node: node.create_subscription(Int32, "t", None, 1), RuntimeError, "one argument"),
        (lambda node: node.create_subscription(Int32, "t", lambda: 0, 1), RuntimeError, "one argument"),
        (lambda node: node.create_client(Int32, "s"), RuntimeError, "is not valid"),
        (lambda node: node.create_service(Int32, "s", print), RuntimeError, "is not valid"),
        (lambda node: node.create_timer(-1.0, None), RCLError, "non-negative"),
        (lambda node: node.create_rate(0), ValueError, "frequency must be > 0"),
    ],
)
def test_wrong_arguments_are_refused(
    make: Callable[[Node], object], error: type[Exception], text: str
) -> None:
    def check(node: Node) -> None:
        with pytest.raises(error, match=text):
            make(node)
        assert [each.topic_name for each in node.publishers] == ["/parameter_events"]
        assert not [*node.clients, *node.timers]

    with_node(check)


def test_a_publisher_can_be_of_the_programs_own_class() -> None:
    class Own(Publisher):
        pass

    def check(node: Node) -> None:
        assert isinstance(node.create_publisher(Int32, "t", 1, publisher_class=Own), Own)

    with_node(check)


def test_a_node_is_gone_after_its_with_block() -> None:
    def program(_: Simulation) -> None:
        with rclpy.create_node("n") as node:
            assert node.get_node_names() == ["n"]
        assert Node("m").get_node_names() == ["m"]

    simulate(program, distro="kilted")


@pytest.mark.parametrize("method", ["create_publisher", "declare_parameters", "count_publishers"])
def test_a_wrong_call_is_told_as_one_of_node(method: str) -> None:
    with pytest.raises(TypeError, match=rf"^Node\.{method}\(\) missing"):
        getattr(Node, method)()


@pytest.mark.parametrize(
    "name", ["Timer", "Rate", "Client", "Service", "Subscription", "Publisher", "ParameterValue"]
)
def test_classes_that_programs_import_from_the_nodes_module_are_there(name: str) -> None:
    assert getattr(importlib.import_module("sim.ros.rclpy.node"), name).__name__ == name
