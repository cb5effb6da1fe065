"""``ros2 topic echo``: what it prints of which messages."""

import pytest

from sim.interfaces import message
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from tests.shell.lines import Setup, carry_out
from tests.support.simulation import Simulation

Int32 = message("std_msgs", "Int32")
Twist = message("geometry_msgs", "Twist")
LaserScan = message("sensor_msgs", "LaserScan")


def counting(simulation: Simulation) -> None:
    """A publisher that counts ten times a second, from 0.05 s on."""
    simulation.publisher_at_rate("count", 0.1, offset=0.05)


def once_a_second(sent: object, qos: QoSProfile | int = 10) -> Setup:
    """A publisher of one message on /t, each second from 0.5 s on."""

    def setup(simulation: Simulation) -> None:
        publisher = simulation.outside_node().create_publisher(type(sent), "/t", qos)

        def run() -> None:
            simulation.sleep(0.5)
            while True:
                publisher.publish(sent)
                simulation.sleep(1.0)

        simulation.start(run)

    return setup


def test_messages_are_printed_as_they_come_with_a_rule_after_each() -> None:
    result = carry_out("topic echo /count", counting, interrupt_at=0.3)
    assert result.out == "data: 0\n---\ndata: 1\n---\ndata: 2\n---\n"
    assert [each.at for each in result.said[::2]] == [0.05, 0.15, 0.25]
    assert result.status == 2


def test_once_ends_with_the_first_message() -> None:
    result = carry_out("ros2 topic echo --once /t", once_a_second(Twist()))
    assert result.out == (
        "linear:\n  x: 0.0\n  y: 0.0\n  z: 0.0\nangular:\n  x: 0.0\n  y: 0.0\n  z: 0.0\n---\n"
    )
    assert (result.status, result.said[-1].at) == (0, 0.5)


def test_a_timeout_ends_the_line() -> None:
    result = carry_out("topic echo --timeout 0.2 /count", counting)
    assert (result.out, result.status) == ("data: 0\n---\ndata: 1\n---\n", 0)


@pytest.mark.parametrize(
    ("options", "out"),
    [
        ("--csv", "0.5,0.0,0.0,0.0,0.0,0.0\n"),
        ("--field linear", "x: 0.5\ny: 0.0\nz: 0.0\n---\n"),
        ("--field linear.x", "0.5\n---\n"),
        ("--flow-style", "{linear: {x: 0.5, y: 0.0, z: 0.0}, angular: {x: 0.0, y: 0.0, z: 0.0}}\n---\n"),
        ("--filter 'm.linear.x > 0' --field linear.x --filter 'm > 0.4'", "0.5\n---\n"),
    ],
)
def test_options_choose_what_is_shown(options: str, out: str) -> None:
    twist = Twist()
    twist.linear.x = 0.5
    assert carry_out(f"topic echo --once {options} /t", once_a_second(twist)).out == out


def test_a_filter_leaves_messages_out() -> None:
    line = "topic echo --once --filter 'm.data % 4 == 3' /count"
    assert carry_out(line, counting).out == "data: 3\n---\n"


def test_arrays_can_be_left_out_and_are_cut_by_default() -> None:
    scan = once_a_second(LaserScan(ranges=[1.0] * 200), qos_profile_sensor_data)
    assert carry_out("topic echo --once /t", scan).out.count("- 1.0\n") == 128
    assert carry_out("topic echo --once -f /t", scan).out.count("- 1.0\n") == 200
    shown = carry_out("topic echo --once --no-arr /t", scan).out
    assert "ranges: '<sequence type: float, length: 200>'\n" in shown


def test_raw_messages_are_bytes() -> None:
    out = carry_out("topic echo --once --raw /t", once_a_second(Int32(data=1))).out
    assert out == f"{bytes((0, 1, 0, 0, 1, 0, 0, 0))!r}\n---\n"


def test_message_info_tells_when_it_was_sent() -> None:
    out = carry_out("topic echo --once --include-message-info /t", once_a_second(Int32())).out
    assert out.startswith("source_timestamp: ")
    assert "publication_sequence_number: 1\n" in out
    assert out.endswith("\n---\ndata: 0\n---\n")


def test_a_best_effort_publisher_is_heard_without_asking() -> None:
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    assert carry_out("topic echo --once /t", once_a_second(Int32(), qos)).status == 0


def test_publishers_of_several_qualities_are_all_heard() -> None:
    def both(simulation: Simulation) -> None:
        once_a_second(Int32(data=1))(simulation)
        once_a_second(Int32(data=2), qos_profile_sensor_data)(simulation)

    result = carry_out("topic echo --csv /t", both, interrupt_at=1.0)
    assert result.out == (
        "Some, but not all, publishers are offering QoSReliabilityPolicy.RELIABLE. Falling back to "
        "QoSReliabilityPolicy.BEST_EFFORT as it will connect to all publishers\n1\n2\n"
    )


def test_an_unknown_topic_is_said_as_ros2_says_it() -> None:
    result = carry_out("topic echo /nowhere")
    assert result.out == "WARNING: topic [/nowhere] does not appear to be published yet\n"
    assert result.err == "Could not determine the type for the passed topic\n"
    assert result.status == 1


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("topic echo /t --field no", "Invalid field 'no': 'Int32' object has no attribute 'no'\n"),
        ("topic echo /t std_msgs/msg/No", "The passed message type is invalid: std_msgs has no message 'No'\n"),  # noqa: E501
        ("topic echo /t --filter 'm.'", "Invalid filter expression 'm.': invalid syntax\n"),
        ("topic echo /t --filter 'm.no'", "The filter 'm.no' raised AttributeError: 'Int32' object has no "
         "attribute 'no'\n"),
    ],
)  # fmt: skip
def test_a_wrong_line_says_what_is_wrong(line: str, complaint: str) -> None:
    result = carry_out(line, once_a_second(Int32()))
    assert result.err == complaint
    assert result.status == 1


def test_a_topic_of_two_types_is_not_echoed() -> None:
    def two_types(_: Simulation) -> None:
        node = Node("n")
        node.create_publisher(Int32, "/t", 10)
        node.create_publisher(Twist, "/t", 10)

    result = carry_out("topic echo /t", two_types)
    assert result.err == (
        "Cannot echo topic '/t', as it contains more than one type: [geometry_msgs/msg/Twist, "
        "std_msgs/msg/Int32]\n"
    )
