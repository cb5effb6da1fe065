"""Topics: what a queue keeps, who hears whom, and what is refused."""

from itertools import permutations
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.clock.strategies import RandomWalk
from sim.interfaces import message
from sim.ros.exceptions import InvalidHandle, InvalidTopicNameException
from sim.ros.node.node import Node
from sim.ros.qos.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_default,
    qos_profile_parameters,
    qos_profile_sensor_data,
    qos_profile_services_default,
)
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.trace.events import CallbackStarted, EntityId, EntityReady, Logged, MessageDropped, WaitStarted
from tests.support.simulation import Simulation, Trace, simulate

Int32 = message("std_msgs", "Int32")
String = message("std_msgs", "String")

BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL)


def hear(subscription_qos: QoSProfile | int, publisher_qos: QoSProfile | int, count: int) -> list[int]:
    """What a subscription hears of so many messages that were published before anybody spun."""
    heard: list[int] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_subscription(Int32, "t", lambda msg: heard.append(msg.data), subscription_qos)
        publisher = node.create_publisher(Int32, "t", publisher_qos)
        for number in range(count):
            publisher.publish(Int32(data=number))
        rclpy.spin(node)

    simulate(program, until=1.0)
    return heard


def test_keep_last_keeps_the_newest_and_an_int_is_a_depth() -> None:
    assert hear(3, 10, 5) == [2, 3, 4]
    assert hear(QoSProfile(depth=2), 10, 5) == [3, 4]


def test_a_depth_of_zero_keeps_one() -> None:
    with pytest.warns(UserWarning, match="A zero depth with KEEP_LAST"):
        assert hear(0, 10, 5) == [4]


def test_keep_all_loses_nothing() -> None:
    assert hear(KEEP_ALL, 10, 500) == list(range(500))


def test_the_oldest_are_dropped_first_and_every_drop_is_on_the_trace() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_subscription(Int32, "t", lambda _: None, 2)
        publisher = node.create_publisher(Int32, "t", 10)
        for _ in range(4):
            publisher.publish(Int32())

    trace = simulate(program)
    assert [(each.message, each.depth) for each in trace.of(EntityReady)] == [(1, 1), (2, 2), (3, 2), (4, 2)]
    assert [(each.message, each.depth) for each in trace.of(MessageDropped)] == [(1, 1), (2, 1)]


def test_the_default_profiles_are_rclpys() -> None:
    assert (qos_profile_default.depth, qos_profile_default.reliability) == (10, ReliabilityPolicy.RELIABLE)
    assert qos_profile_default.durability == DurabilityPolicy.VOLATILE
    assert qos_profile_sensor_data.depth == 5
    assert qos_profile_sensor_data.reliability == ReliabilityPolicy.BEST_EFFORT
    assert (qos_profile_services_default.depth, qos_profile_parameters.depth) == (10, 1000)


@pytest.mark.parametrize(
    ("subscription_qos", "publisher_qos"),
    [(10, BEST_EFFORT), (LATCHED, 10)],
    ids=["reliability", "durability"],
)
def test_a_subscription_that_asks_for_more_than_is_offered_hears_nothing(
    subscription_qos: QoSProfile | int, publisher_qos: QoSProfile | int
) -> None:
    assert hear(subscription_qos, publisher_qos, 3) == []


@pytest.mark.parametrize(
    ("subscription_qos", "publisher_qos"),
    [(BEST_EFFORT, 10), (BEST_EFFORT, BEST_EFFORT), (10, LATCHED), (LATCHED, LATCHED)],
)
def test_a_subscription_that_asks_for_no_more_than_is_offered_hears_everything(
    subscription_qos: QoSProfile | int, publisher_qos: QoSProfile | int
) -> None:
    assert hear(subscription_qos, publisher_qos, 3) == [0, 1, 2]


@pytest.mark.parametrize(
    ("subscription_qos", "publisher_qos", "policy"),
    [(10, BEST_EFFORT, "RELIABILITY"), (LATCHED, 10, "DURABILITY")],
)
def test_both_sides_of_a_mismatch_warn_once_while_spinning(
    subscription_qos: QoSProfile | int, publisher_qos: QoSProfile | int, policy: str
) -> None:
    def program(simulation: Simulation) -> None:
        speaker, listener = Node("speaker"), Node("listener")
        publisher = speaker.create_publisher(Int32, "t", publisher_qos)
        listener.create_subscription(Int32, "/t", lambda _: None, subscription_qos)
        publisher.publish(Int32())
        simulation.sleep(1.0)
        assert not Trace(simulation.events).said()
        for _ in range(3):
            for node in (speaker, listener):
                rclpy.spin_once(node, timeout_sec=1.0)

    trace = simulate(program)
    assert [(str(each.severity), each.logger, each.text) for each in trace.of(Logged)] == [
        (
            "WARN",
            "speaker",
            "New subscription discovered on topic 't', requesting incompatible QoS. "
            f"No messages will be sent to it. Last incompatible policy: {policy}",
        ),
        (
            "WARN",
            "listener",
            "New publisher discovered on topic '/t', offering incompatible QoS. "
            f"No messages will be received from it. Last incompatible policy: {policy}",
        ),
    ]


def test_a_late_subscription_gets_the_last_messages_of_a_transient_local_publisher() -> None:
    heard: list[int] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(Int32, "t", LATCHED)
        for number in range(5):
            publisher.publish(Int32(data=number))
        simulation.sleep(1.0)
        node.create_subscription(Int32, "t", lambda msg: heard.append(msg.data), LATCHED)
        publisher.publish(Int32(data=5))
        rclpy.spin(node)

    simulate(program, until=2.0)
    assert heard == [3, 4, 5]


def test_a_late_volatile_subscription_gets_nothing_of_the_past() -> None:
    heard: list[int] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(Int32, "t", LATCHED)
        publisher.publish(Int32(data=1))
        node.create_subscription(Int32, "t", lambda msg: heard.append(msg.data), 10)
        rclpy.spin(node)

    simulate(program, until=1.0)
    assert heard == []


def test_a_message_from_the_past_waits_since_it_came_and_is_as_old_as_its_publication() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_publisher(Int32, "t", LATCHED).publish(Int32())
        simulation.sleep(4.0)
        node.create_subscription(Int32, "t", lambda _: None, LATCHED)
        simulation.sleep(1.0)
        rclpy.spin(node)

    trace = simulate(program, until=6.0)
    (wait,) = trace.of(WaitStarted)
    (start,) = trace.of(CallbackStarted)
    assert (wait.since, start.t, start.age) == (4_000_000_000, 5_000_000_000, 5_000_000_000)


def test_a_publisher_sends_a_copy_and_every_subscription_gets_its_own() -> None:
    heard: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def spoil(msg: object) -> None:
            heard.append(msg.data)  # type: ignore[attr-defined]
            msg.data = "spoilt"  # type: ignore[attr-defined]

        for _ in range(2):
            node.create_subscription(String, "t", spoil, 10)
        sent = String(data="as sent")
        node.create_publisher(String, "t", 10).publish(sent)
        sent.data = "changed"
        rclpy.spin(node)
        assert sent.data == "changed"

    simulate(program, until=1.0)
    assert heard == ["as sent", "as sent"]


def test_publishing_another_class_is_a_type_error_that_names_both() -> None:
    def program(simulation: Simulation) -> None:
        publisher = Node("n").create_publisher(Int32, "t", 10)
        for wrong in (String(), 5, None):
            with pytest.raises(TypeError) as caught:
                publisher.publish(wrong)
            assert str(caught.value) == f"Expected {Int32}, got {type(wrong)}"

    simulate(program)


def test_a_topic_of_another_type_is_not_heard() -> None:
    heard: list[object] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_subscription(String, "t", heard.append, 10)
        node.create_publisher(Int32, "t", 10).publish(Int32())
        rclpy.spin(node)

    simulate(program, until=1.0)
    assert heard == []


def test_something_else_than_a_profile_or_a_depth_is_refused() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        for wrong in ("10", None, 1.5, True):
            with pytest.raises(TypeError, match="Expected QoSProfile or int, but received"):
                node.create_publisher(Int32, "t", wrong)  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="history depth must be greater than or equal to zero"):
            node.create_subscription(Int32, "t", lambda _: None, -1)

    simulate(program)


def test_names_are_relative_absolute_or_private_and_bad_ones_are_refused() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n", namespace="arm")
        names = {"t": "/arm/t", "/t": "/t", "~/t": "/arm/n/t", "{node}/t": "/arm/n/t"}
        for short, full in names.items():
            assert node.create_publisher(Int32, short, 10).topic_name == full
        with pytest.raises(InvalidTopicNameException):
            node.create_publisher(Int32, "a b", 10)

    simulate(program)


def test_a_destroyed_publisher_cannot_publish_and_a_destroyed_subscription_hears_nothing() -> None:
    heard: list[object] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        subscription = node.create_subscription(Int32, "t", heard.append, 10)
        publisher = node.create_publisher(Int32, "t", 10)
        assert (publisher.get_subscription_count(), subscription.get_publisher_count()) == (1, 1)
        assert node.destroy_subscription(subscription)
        assert publisher.get_subscription_count() == 0
        publisher.publish(Int32())
        assert node.destroy_publisher(publisher)
        assert not node.destroy_publisher(publisher)
        with pytest.raises(InvalidHandle):
            publisher.publish(Int32())
        rclpy.spin(node)

    simulate(program, until=1.0)
    assert heard == []


def test_one_publisher_reaches_the_subscriptions_of_every_node_at_once() -> None:
    def program(simulation: Simulation) -> None:
        first, second = Node("first"), Node("second")
        for node in (first, second):
            node.create_subscription(
                Int32, "t", lambda _: None, 10, callback_group=MutuallyExclusiveCallbackGroup()
            )
        simulation.publisher_at_rate("t", 1.0, offset=1.0)
        executor = rclpy.get_global_executor()
        executor.add_node(second)
        rclpy.spin(first)

    assert simulate(program, until=2.5).times("<lambda>") == [1.0, 1.0, 2.0, 2.0]


def test_a_publisher_keeps_one_order_of_the_subscriptions_it_found_which_is_any_where_threads_race() -> None:
    # Fast DDS on Jazzy and Kilted: four that were there came as 3, 1, 0, 2 each time; later ones as made.
    def arrivals(seed: int) -> tuple[EntityId, ...]:
        def program(simulation: Simulation) -> None:
            node = Node("n")

            def listen() -> None:
                node.create_subscription(Int32, "t", lambda _: None, 10)

            for _ in range(3):
                listen()
            publisher = node.create_publisher(Int32, "t", 10)
            listen()
            for _ in range(2):
                publisher.publish(Int32())

        came = [each.entity for each in simulate(program, schedule=RandomWalk(seed)).of(EntityReady)]
        *found, last = came[:4]
        assert came == [*found, last] * 2
        assert last == max(came)
        return tuple(found)

    usual = arrivals(1)
    assert list(usual) == sorted(usual)
    assert {arrivals(seed) for seed in range(3, 20, 2)} == {usual}
    assert {arrivals(seed) for seed in range(0, 60, 2)} == set(permutations(usual))


def test_a_message_counts_as_its_class_until_it_is_asked_whether_what_is_published_is_of_it() -> None:
    heard: list[int] = []
    instance: Any = Int32()

    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_subscription(instance, "t", lambda msg: heard.append(msg.data), 10)
        node.create_publisher(Int32, "t", 10).publish(Int32(data=5))
        with pytest.raises(TypeError, match="arg 2 must be a type, a tuple of types, or a union"):
            node.create_publisher(instance, "t", 10).publish(Int32(data=6))
        rclpy.spin_once(node)

    simulate(program)
    assert heard == [5]
