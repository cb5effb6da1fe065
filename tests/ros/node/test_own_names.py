"""A program's node may call its attributes and methods almost anything."""

from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.ros.node.node import Node
from sim.trace.events import Logged, Severity
from tests.support.simulation import Simulation, simulate

LIKELY = [
    "_name",
    "_names",
    "_host",
    "_node",
    "_nodes",
    "_count",
    "_full",
    "_executor",
    "_entities",
    "_pending",
    "_orders",
    "_warnings",
    "_timer",
    "_timer_queue",
    "_store",
    "_drop",
    "_declare",
    "_group",
    "_add",
    "_remove",
    "_offer",
    "_of",
    "_next_order",
    "_timer_set",
    "_remapping",
    "_publisher",
    "_subscription",
    "_service",
    "_client",
    "_queue",
    "_state",
    "_running",
    "_lock",
    "_thread",
    "_callback",
    "_signal",
    "_waiting",
]


class Crowded(Node):
    """Uses every likely private name for something of its own."""

    def __init__(self) -> None:
        super().__init__("crowded")
        anything: Any = self
        for name in LIKELY:
            setattr(anything, name, None)
        self.create_timer(0.5, self.tick)

    def tick(self) -> None:
        """Do nothing."""


def test_a_node_with_attributes_of_likely_names_still_works() -> None:
    def program(_simulation: Simulation) -> None:
        node = Crowded()
        node.declare_parameter("speed", 1.0)
        assert node.get_parameter("speed").value == 1.0
        assert node.get_node_names() == ["crowded"]
        assert node.count_publishers("/parameter_events") == 1
        rclpy.spin(node)

    assert simulate(program, until=1.6).times("tick") == [0.5, 1.0, 1.5]


class Hiding(Node):
    """Has a tuple of the name under which rclpy's executors look for timers."""

    timers: Any = ()


def test_a_class_that_hides_what_executors_look_for_is_told_so() -> None:
    trace = simulate(lambda _: Hiding("h"))
    (line,) = trace.of(Logged)
    assert line.severity is Severity.WARN
    assert line.text.startswith("Hiding.timers hides the timers of rclpy's nodes: real executors ")


def test_a_name_that_a_class_makes_up_is_asked_when_a_node_is_made_as_in_rclpy() -> None:
    class Greeter(Node):
        def get_name(self, person: str) -> str:  # type: ignore[override]
            return person

    def program(simulation: Simulation) -> None:
        with pytest.raises(TypeError, match="missing 1 required positional argument: 'person'"):
            Greeter("n")

    simulate(program)
