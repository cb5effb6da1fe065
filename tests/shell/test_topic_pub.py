"""``ros2 topic pub``: when it publishes what, and what it prints."""

from typing import Any

import pytest

from sim.interfaces import message
from sim.ros.node.node import Node
from sim.trace.events import NodeAppeared, Published
from tests.shell.lines import carry_out, hear, spin
from tests.support.simulation import Simulation

Twist = message("geometry_msgs", "Twist")
Int32 = message("std_msgs", "Int32")

COURSE_LINE = """ros2 topic pub /cmd_vel geometry_msgs/msg/Twist "linear:
  x: 0.0
  y: 0.0
  z: 0.0
angular:
  x: 0.0
  y: 0.0
  z: 0.0
"
"""


def test_the_courses_line_publishes_every_second_until_it_is_interrupted() -> None:
    result = carry_out(COURSE_LINE, interrupt_at=2.5)
    zero = repr(Twist())
    assert result.out == "publisher: beginning loop\n" + "".join(
        f"publishing #{number}: {zero}\n\n" for number in (1, 2, 3)
    )
    assert [each.t / 1e9 for each in result.trace.of(Published)] == [0.0, 1.0, 2.0]
    assert {each.topic for each in result.trace.of(Published)} == {"/cmd_vel"}
    assert not result.trace.of(NodeAppeared)
    assert result.status == 2


def test_once_waits_for_somebody_who_listens() -> None:
    heard: list[Any] = []

    def later(simulation: Simulation) -> None:
        def come_up() -> None:
            simulation.sleep(2.05)
            node = Node("listener")
            hear(node, Int32, "/t", heard)
            spin(simulation, node)

        simulation.start(come_up)

    result = carry_out("topic pub --once /t std_msgs/msg/Int32 'data: 5'", later)
    assert result.out == (
        "Waiting for at least 1 matching subscription(s)...\n" * 3
        + "publisher: beginning loop\npublishing #1: std_msgs.msg.Int32(data=5)\n\n"
    )
    assert [each.data for each in heard] == [5]
    assert result.status == 0


def test_times_rate_and_print_are_obeyed() -> None:
    result = carry_out("topic pub -t 5 -w 0 -r 10 -p 2 /t std_msgs/msg/Int32")
    assert [each.text[:13] for each in result.said if each.text] == [
        "publisher: be",
        "publishing #2",
        "publishing #4",
    ]
    assert [each.t / 1e9 for each in result.trace.of(Published)] == [0.0, 0.1, 0.2, 0.3, 0.4]
    assert result.status == 0


def test_the_node_lives_on_for_as_long_as_it_is_told() -> None:
    counts: list[int] = []

    def watch(simulation: Simulation) -> None:
        looker = Node("looker")
        simulation.at(1.9, lambda: counts.append(looker.count_publishers("/t")))

    carry_out("topic pub -1 -w 0 --keep-alive 2 /t std_msgs/msg/Int32", watch)
    carry_out("topic pub -1 -w 0 --keep-alive 1 /t std_msgs/msg/Int32", watch, at=0.5)
    assert counts == [1]


def test_quality_of_service_is_as_asked_for() -> None:
    heard: list[Any] = []

    def listener(simulation: Simulation) -> None:
        node = Node("listener")
        hear(node, Int32, "/t", heard)
        spin(simulation, node)

    unheard = carry_out("topic pub -1 -w 0 --qos-reliability best_effort /t std_msgs/msg/Int32", listener)
    assert heard == []
    assert "requesting incompatible QoS. No messages will be sent to it." in unheard.err
    carry_out("topic pub -1 -w 0 --qos-profile services_default /t std_msgs/msg/Int32", listener)
    assert len(heard) == 1


def test_now_is_the_time_of_each_message() -> None:
    line = "topic pub -t 2 -w 0 /t geometry_msgs/msg/PointStamped 'header: auto'"
    first, second = (each.text for each in carry_out(line).said if "publishing" in each.text)
    assert first != second.replace("#2", "#1")


@pytest.mark.parametrize(
    ("line", "complaint", "status"),
    [
        ("topic pub /t std_msgs/msg/Strin", "The passed message type is invalid: std_msgs has no message 'Strin'; "  # noqa: E501
         "did you mean 'String'?\n", 1),
        ("topic pub /t std_msgs/msg/Int32 5", "The passed value needs to be a dictionary in YAML format\n", 1),  # noqa: E501
        ("topic pub /t std_msgs/msg/Int32 '{data: '", "The passed value needs to be a dictionary in YAML format: "  # noqa: E501
         "did not find expected node content (line 1)\n", 1),
        ("topic pub /t std_msgs/msg/Int32 '{dat: 1}'", "Failed to populate field: 'Int32' object has no "
         "attribute 'dat'\n", 1),
    ],
)  # fmt: skip
def test_a_wrong_line_says_what_is_wrong(line: str, complaint: str, status: int) -> None:
    result = carry_out(line)
    assert (result.out, result.err, result.status) == ("", complaint, status)


def test_a_rate_that_is_none_is_refused() -> None:
    result = carry_out("topic pub -r 0 /t std_msgs/msg/Int32")
    assert result.err.startswith("ros2 topic pub: error: argument -r/--rate: value must be positive (see ")
    assert result.status == 2
