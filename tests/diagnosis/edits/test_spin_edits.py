"""Edits of programs that spin one node after another."""

from pathlib import Path

import pytest

from sim.diagnosis.edits.spins import spin_together, spins_in_turn
from tests.diagnosis.edits.edited_source import changed


def test_nodes_that_are_spun_in_turn_are_spun_by_one_executor() -> None:
    main = "def main():\n    rclpy.spin(a)  # here\n    a.log()\n    rclpy.spin(self.b)\n    a.log()\n"
    assert changed(f"import rclpy\n\n\n{main}", spin_together) == [
        "+from rclpy.executors import SingleThreadedExecutor",
        "-    rclpy.spin(a)  # here",
        "+    executor = SingleThreadedExecutor()",
        "+    executor.add_node(a)",
        "+    executor.add_node(self.b)",
        "+    executor.spin()",
        "-    rclpy.spin(self.b)",
    ]


def test_of_executors_that_are_spun_in_turn_the_first_gets_all_nodes() -> None:
    made = "one = SingleThreadedExecutor()\none.add_node(a)\ntwo = MultiThreadedExecutor()\ntwo.add_node(b)\n"
    assert changed(f"{made}one.spin()  # here\ntwo.spin()\n", spin_together) == [
        "-two.add_node(b)",
        "+one.add_node(b)",
        "-two.spin()",
    ]


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("rclpy.spin(a)\nrclpy.spin(b)\nrclpy.spin(c)\n", (1, 2, 3)),
        ("rclpy.spin(a)\n", ()),
        ("if a:\n    rclpy.spin(a)\nelse:\n    rclpy.spin(b)\n", ()),
        ("robot.spin()\nrobot.spin()\n", ()),
        ("def f():\n    rclpy.spin(a)\n    rclpy.spin(b)\n\nrclpy.spin(a)\nrclpy.spin(b)\n", ()),
        ("rclpy.spin(", ()),
    ],
)
def test_spins_in_turn_are_those_of_one_body(text: str, lines: tuple[int, ...], tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(text)
    assert spins_in_turn(str(path)) == lines


def test_a_spin_of_a_node_and_one_of_an_executor_stay() -> None:
    text = "import rclpy\none = SingleThreadedExecutor()\nrclpy.spin(a)  # here\none.spin()\n"
    assert changed(text, spin_together) is None
