"""``/rosout``: the log lines of nodes as messages, for whoever listens."""

from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import rcl_interfaces
from sim.ros.context.context import Context
from sim.ros.entities.event_handler import SubscriptionEventCallbacks
from sim.ros.logging.logger import LoggingSeverity, get_logger
from sim.ros.node.node import Node
from sim.ros.parameters.parameter import Parameter
from sim.ros.qos.qos import DurabilityPolicy, QoSProfile
from sim.trace.events import EntityReady, Published
from tests.support.simulation import Simulation, simulate

LATE = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def listen(node: Node, qos: QoSProfile | int = 10) -> list[Any]:
    heard: list[Any] = []
    node.create_subscription(rcl_interfaces.Log, "/rosout", heard.append, qos)
    return heard


def drain(node: Node) -> None:
    for _ in range(10):
        rclpy.spin_once(node, timeout_sec=0.0)


def test_a_line_is_a_message_with_its_place() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("talker", namespace="/ns")
        heard = listen(node)
        simulation.sleep(1.5)
        node.get_logger().warning("SOMETHING")
        drain(node)
        (log,) = heard
        assert (log.name, log.msg, log.level) == ("ns.talker", "SOMETHING", LoggingSeverity.WARN)
        assert log.file == __file__
        assert log.function == "program"
        assert log.line > 0
        assert log.stamp == node.get_clock().now().to_msg()

    simulate(program)


def test_children_speak_through_their_nodes_logger_and_others_do_not() -> None:
    def program(_: Simulation) -> None:
        node = Node("talker")
        heard = listen(node)
        node.get_logger().get_child("a").get_child("b").info("child")
        get_logger("talker").info("by name")
        get_logger("stranger").info("nobody's")
        get_logger("talker.a").info("of no child")
        node.get_logger().debug("below the level")
        drain(node)
        assert [(each.name, each.msg) for each in heard] == [("talker.a.b", "child"), ("talker", "by name")]

    simulate(program)


@pytest.mark.parametrize(
    ("arguments", "enable", "expected"),
    [
        (["--enable-rosout-logs"], True, True),
        ([], True, True),
        ([], False, False),
        (["--disable-rosout-logs"], True, False),
        (["--disable-rosout-logs"], False, False),
    ],
)
def test_program_and_node_have_to_want_it(arguments: list[str], enable: bool, expected: bool) -> None:
    def program(_: Simulation) -> None:
        context = Context()
        context.init(["--ros-args", *arguments])
        node = Node("talker", context=context, enable_rosout=enable)
        assert node.count_publishers("/rosout") == expected
        listener = Node("listener", enable_rosout=False)
        heard = listen(listener)
        node.get_logger().info("x")
        drain(listener)
        assert len(heard) == expected

    simulate(program)


def test_the_graph_shows_it() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        assert ("/rosout", ["rcl_interfaces/msg/Log"]) in node.get_topic_names_and_types()
        names = dict(node.get_publisher_names_and_types_by_node("n", "/"))
        assert set(names) == {"/rosout", "/parameter_events"}
        (info,) = node.get_publishers_info_by_topic("/rosout")
        assert (info.qos_profile.depth, info.qos_profile.durability) == (1000, LATE.durability)
        assert "/rosout" not in [each.topic_name for each in node.publishers]
        node.destroy_node()
        assert Node("other").count_publishers("/rosout") == 1

    simulate(program)


def test_late_subscriptions_get_the_lines_of_the_last_ten_seconds() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        for second in range(4):
            node.get_logger().info(str(second))
            simulation.sleep(1.0)
        simulation.sleep(7.5)
        heard, volatile = listen(node, LATE), listen(node)
        drain(node)
        assert [each.msg for each in heard] == ["2", "3"]
        assert not volatile

    simulate(program)


def test_nothing_of_it_is_on_the_trace_until_somebody_listens() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        node.declare_parameter("p", 1)
        node.get_logger().info("unheard")
        node.set_parameters([Parameter("p", value=2)])
        publisher = node.create_publisher(rcl_interfaces.Log, "t", 1)
        publisher.publish(rcl_interfaces.Log())

    trace = simulate(program)
    assert [each.message for each in trace.of(Published)] == [1]
    assert not trace.of(EntityReady)
    assert trace.said() == ["unheard"]


def test_a_destroyed_node_is_silent() -> None:
    def program(_: Simulation) -> None:
        node, listener = Node("n"), Node("listener")
        heard = listen(listener)
        node.destroy_node()
        node.get_logger().info("x")
        drain(listener)
        assert not heard

    simulate(program)


def test_nodes_of_one_name_share_a_publisher() -> None:
    def program(_: Simulation) -> None:
        first, second = Node("n"), Node("n")
        heard = listen(first)
        second.get_logger().info("x")
        drain(first)
        assert [each.msg for each in heard] == ["x"]
        assert first.count_publishers("/rosout") == 1

    assert "Publisher already registered for node name: 'n'." in simulate(program).said()[0]


def test_a_subscription_matches_like_any_other() -> None:
    def program(_: Simulation) -> None:
        node, matched = Node("n"), []
        events = SubscriptionEventCallbacks(matched=lambda info: matched.append(info.current_count))
        node.create_subscription(rcl_interfaces.Log, "/rosout", lambda _: None, 1, event_callbacks=events)
        drain(node)
        assert matched == [1]

    simulate(program)
