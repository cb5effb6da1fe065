"""Callbacks for changes of parameters."""

from functools import partial
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import rcl_interfaces as rcl
from sim.ros.node.node import Node
from sim.ros.node.parameter_event_handler import ParameterEventHandler
from sim.ros.parameters.parameter import Parameter
from tests.support.simulation import Simulation, simulate


def spin(node: Node) -> None:
    """Let everything that arrived be handled."""
    for _ in range(8):
        rclpy.spin_once(node, timeout_sec=0.0)


def test_new_and_changed_parameters_are_found_in_an_event() -> None:
    new, changed, gone = (Parameter(name, value=1).to_parameter_msg() for name in ("new", "changed", "gone"))
    event = rcl.ParameterEvent(
        node="/n", new_parameters=[new], changed_parameters=[changed], deleted_parameters=[gone]
    )
    find = ParameterEventHandler.get_parameter_from_event
    assert find(event, "new", "/n") == new
    assert find(event, "changed", "/n") == changed
    assert find(event, "gone", "/n") is None
    assert find(event, "new", "/m") is None
    assert list(ParameterEventHandler.get_parameters_from_event(event)) == [new, changed]


def test_a_parameters_callback_hears_of_that_parameter_of_that_node() -> None:
    heard: list[tuple[str, Any]] = []

    def note(name: str, parameter: Any) -> None:
        heard.append((name, parameter.value.integer_value))

    def program(_: Simulation) -> None:
        node, other = Node("n", namespace="arm"), Node("other", namespace="arm")
        handler = ParameterEventHandler(node)
        for name in ("", "other", "/arm/other", "/other"):
            handler.add_parameter_callback("a", name, partial(note, name))
        node.declare_parameter("a", 1)
        other.declare_parameter("a", 2)
        other.declare_parameter("b", 3)
        spin(node)

    simulate(program)
    assert heard == [("", 1), ("/arm/other", 2), ("other", 2)]


def test_the_newest_callback_is_called_first_and_events_last() -> None:
    heard: list[str] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        handler = ParameterEventHandler(node)
        handler.add_parameter_event_callback(lambda _: heard.append("event 1"))
        handler.add_parameter_event_callback(lambda _: heard.append("event 2"))
        handler.add_parameter_callback("a", "n", lambda _: heard.append("parameter 1"))
        handler.add_parameter_callback("a", "n", lambda _: heard.append("parameter 2"))
        node.declare_parameter("a", 1)
        spin(node)

    simulate(program)
    assert heard == ["parameter 2", "parameter 1", "event 2", "event 1"]


def test_a_removed_callback_is_not_called() -> None:
    heard: list[object] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        handler = ParameterEventHandler(node)
        one = handler.add_parameter_callback("a", "n", heard.append)
        every = handler.add_parameter_event_callback(heard.append)
        handler.remove_parameter_callback(one)
        handler.remove_parameter_event_callback(every)
        node.declare_parameter("a", 1)
        spin(node)
        with pytest.raises(KeyError):
            handler.remove_parameter_callback(one)
        with pytest.raises(ValueError, match="not in list"):
            handler.remove_parameter_event_callback(every)

    simulate(program)
    assert heard == []


def test_a_handler_can_be_told_whom_to_hear() -> None:
    heard: list[str] = []

    def program(_: Simulation) -> None:
        node, other = Node("n"), Node("other")
        handler = ParameterEventHandler(node)
        handler.add_parameter_event_callback(lambda event: heard.append(event.node))
        assert handler.configure_nodes_filter(["other"])
        node.declare_parameter("a", 1)
        other.declare_parameter("a", 1)
        spin(node)
        assert handler.configure_nodes_filter()
        node.declare_parameter("b", 1)
        spin(node)

    simulate(program)
    assert heard == ["/other", "/n"]


def test_a_destroyed_handler_hears_nothing() -> None:
    heard: list[object] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        handler = ParameterEventHandler(node)
        handler.add_parameter_event_callback(heard.append)
        handler.destroy()
        node.declare_parameter("a", 1)
        spin(node)

    simulate(program)
    assert heard == []
