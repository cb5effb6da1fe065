"""``ros2 param``: reading and setting the parameters of nodes."""

from pathlib import Path
from typing import Any

import pytest

from sim.interfaces import rcl_interfaces
from sim.ros.node.node import Node
from tests.shell.lines import Setup, carry_out, own, spin
from tests.support.simulation import Simulation


def with_parameters(then: Setup = lambda _: None) -> Setup:
    """A node with one parameter of each kind."""

    def setup(simulation: Simulation) -> None:
        node = Node("n")
        node.declare_parameter("speed", 0.5)
        node.declare_parameter("limits.top", [1, 2])
        node.declare_parameter("name", "robot")
        limits = rcl_interfaces.IntegerRange(from_value=0, to_value=10, step=2)
        descriptor: Any = rcl_interfaces.ParameterDescriptor(
            description="how many", integer_range=[limits], additional_constraints="even"
        )
        node.declare_parameter("count", 4, descriptor)
        node.declare_parameter("fixed", True, rcl_interfaces.ParameterDescriptor(read_only=True))
        spin(simulation, node)
        then(simulation)

    return setup


@pytest.mark.parametrize(
    ("line", "out"),
    [
        ("param list /n", "  count\n  fixed\n  limits.top\n  name\n  speed\n"),
        ("param list", "/n:\n  count\n  fixed\n  limits.top\n  name\n  speed\n"),
        ("param list n --filter sp --param-type", "  speed (type: double)\n"),
        ("param get /n speed", "Double value is: 0.5\n"),
        ("param get /n speed --hide-type", "0.5\n"),
        ("param get /n fixed", "Boolean value is: True\n"),
        ("param get /n count", "Integer value is: 4\n"),
        ("param get /n name", "String value is: robot\n"),
        ("param get /n limits.top", "Integer values are: [1, 2]\n"),
        ("param set /n speed 0.75", "Set parameter successful\n"),
        (
            "param dump /n",
            "/n:\n  ros__parameters:\n    count: 4\n    fixed: true\n    limits:\n      top:\n      - 1\n      - 2\n"  # noqa: E501
            "    name: robot\n    speed: 0.5\n\n",
        ),
        (
            "param describe /n count",
            "Parameter name: count\n  Type: integer\n  Description: how many\n  Constraints:\n"
            "    Min value: 0\n    Max value: 10\n    Step: 2\n    Additional constraints: even\n",
        ),
        (
            "param describe n fixed",
            "Parameter name: fixed\n  Type: boolean\n  Constraints:\n    Read only: true\n",
        ),
    ],
)
def test_what_is_asked_is_answered(line: str, out: str) -> None:
    result = carry_out(line, with_parameters())
    assert (own(result.out), result.err, result.status) == (out, "", 0)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("param list /nobody", "Node not found\n"),
        ("param get /nobody x", "Node not found\n"),
        ("param get /n nope", "Parameter not set.\n"),
        ("param describe /n nope", "Parameter not declared: nope\n"),
        ("param list --filter '('", "The filter '(' is no regular expression: "),
        ("param load /n /nowhere.yaml", "/nowhere.yaml: "),
    ],
)
def test_a_wrong_line_says_what_is_wrong(line: str, complaint: str) -> None:
    result = carry_out(line, with_parameters())
    assert result.err.startswith(complaint)
    assert (result.err.count("\n"), result.status) == (1, 1)


@pytest.mark.parametrize(
    "line", ["param set /n count fast", "param set /n fixed false", "param set /n count 11"]
)
def test_a_value_that_the_node_refuses_is_said_with_its_reason(line: str) -> None:
    result = carry_out(line, with_parameters())
    assert result.err.startswith("Setting parameter failed: ")
    assert result.status == 1


def test_what_was_dumped_can_be_loaded(tmp_path: Path) -> None:
    assert carry_out(f"param dump /n --output-dir {tmp_path}", with_parameters()).status == 0
    text = (tmp_path / "n.yaml").read_text().replace("0.5", "0.9")
    (tmp_path / "n.yaml").write_text(text)
    result = carry_out(f"param load /n {tmp_path / 'n.yaml'}", with_parameters())
    assert "Set parameter speed successful\n" in result.out
    assert result.err.startswith("Set parameter fixed failed: ")


def test_a_parameter_that_may_go_is_deleted() -> None:
    def setup(simulation: Simulation) -> None:
        node = Node("n", allow_undeclared_parameters=True)
        descriptor: Any = rcl_interfaces.ParameterDescriptor(dynamic_typing=True)
        node.declare_parameter("loose", 1, descriptor)
        spin(simulation, node)

    assert carry_out("param delete /n loose", setup).out == "Deleted parameter successfully\n"


def test_a_node_that_nobody_spins_keeps_the_line_waiting() -> None:
    result = carry_out("param get /n x", lambda _: Node("n"), interrupt_at=3.0)
    assert (result.out, result.status) == ("", 2)
    result = carry_out("param list", lambda _: Node("n"))
    assert result.err == "Exception while calling service of node '/n': None\n"


def test_a_line_tells_nobody_of_its_own_parameters() -> None:
    heard: list[str] = []

    def setup(simulation: Simulation) -> None:
        node = Node("n")
        node.declare_parameter("speed", 0.5)
        node.create_subscription(
            rcl_interfaces.ParameterEvent, "/parameter_events", lambda event: heard.append(event.node), 10
        )
        spin(simulation, node)

    carry_out("param set /n speed 0.75", setup)
    assert heard == ["/n"]
