"""``ros2 action``: sending goals."""

from typing import Any

import pytest

from sim.interfaces import action
from sim.ros.actions import ActionServer
from sim.ros.node.node import Node
from tests.shell.lines import carry_out, spin
from tests.support.simulation import Simulation

Fibonacci = action("example_interfaces", "Fibonacci")


def fibonacci(simulation: Simulation) -> None:
    """A server that tells its progress each second."""
    node = Node("server")

    def execute(goal_handle: Any) -> Any:
        sequence = [0, 1]
        for _ in range(goal_handle.request.order - 1):
            simulation.sleep(1.0)
            sequence.append(sequence[-1] + sequence[-2])
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        goal_handle.succeed()
        return Fibonacci.Result(sequence=sequence)

    ActionServer(node, Fibonacci, "fibonacci", execute)
    spin(simulation, node)


@pytest.mark.parametrize(
    ("line", "out"),
    [
        ("action list", "/fibonacci\n"),
        ("action list -t", "/fibonacci [example_interfaces/action/Fibonacci]\n"),
        ("action list -c", "1\n"),
        ("action type /fibonacci", "example_interfaces/action/Fibonacci\n"),
        ("action info /fibonacci", "Action: /fibonacci\nAction clients: 0\nAction servers: 1\n    /server\n"),
        ("topic list --include-hidden-topics -c", None),
    ],
)
def test_what_is_known_of_actions(line: str, out: str | None) -> None:
    result = carry_out(line, fibonacci)
    assert result.status == 0
    assert out in {None, result.out}


def test_a_goal_is_sent_and_its_result_printed() -> None:
    line = "ros2 action send_goal -f /fibonacci example_interfaces/action/Fibonacci '{order: 2}'"
    out = carry_out(line, fibonacci).out
    assert out.startswith(
        "Waiting for an action server to become available...\nSending goal:\n     order: 2\n\nGoal accepted with ID: "  # noqa: E501
    )
    assert "Feedback:\n    sequence:\n- 0\n- 1\n- 1\n\n" in out
    assert out.endswith("Result:\n    sequence:\n- 0\n- 1\n- 1\n\nGoal finished with status: SUCCEEDED\n")


def test_an_interrupt_cancels_the_goal() -> None:
    line = "action send_goal /fibonacci example_interfaces/action/Fibonacci '{order: 5}'"
    result = carry_out(line, fibonacci, interrupt_at=2.0)
    assert result.out.endswith("Canceling goal...\n")
    assert result.status == 2


def test_an_unknown_action_is_named() -> None:
    result = carry_out("action type /x", fibonacci)
    assert (result.err, result.status) == ("Unknown action '/x'\n", 1)
    result = carry_out("action send_goal /x example_interfaces/action/No '{}'", fibonacci)
    assert result.err.startswith("The passed action type is invalid: ")
