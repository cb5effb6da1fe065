"""Deadlines, leases of liveliness and lifespans: what becomes of them as time passes."""

from collections.abc import Callable
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message
from sim.ros.entities.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from sim.ros.entities.publisher import Publisher
from sim.ros.node.node import Node
from sim.ros.qos.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile
from sim.ros.rclpy import executors
from sim.ros.scheduling import callback_groups
from sim.ros.scheduling.executors import MultiThreadedExecutor
from sim.ros.time.duration import Duration
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")


def within(seconds: float) -> Duration:
    return Duration(seconds=seconds)


def hear(_: object) -> None:
    """Take a message."""


class Told:
    """When a callback for an event was called, in whole milliseconds, and with what."""

    def __init__(self, simulation: Simulation, *fields: str) -> None:
        self._simulation = simulation
        self._fields = fields
        self.calls: list[tuple[int, ...]] = []

    def __call__(self, info: Any) -> None:
        values = (getattr(info, each) for each in self._fields)
        self.calls.append((int(self._simulation.now * 1000), *values))


def publish_at(simulation: Simulation, publisher: Publisher, *times: float) -> None:
    for time in times:
        simulation.at(time, lambda: publisher.publish(Int32()))


# Deadlines

DEADLINE = QoSProfile(depth=10, deadline=within(1.0))


def test_both_sides_hear_of_every_deadline_missed() -> None:
    told: list[Told] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        offered = Told(simulation, "total_count", "total_count_change")
        requested = Told(simulation, "total_count", "total_count_change")
        told.extend((offered, requested))
        node.create_subscription(
            Int32, "t", hear, DEADLINE, event_callbacks=SubscriptionEventCallbacks(deadline=requested)
        )
        publisher = node.create_publisher(
            Int32, "t", DEADLINE, event_callbacks=PublisherEventCallbacks(deadline=offered)
        )
        publish_at(simulation, publisher, 1.0, 1.5, 4.0, 4.5)
        simulation.at(5.0, rclpy.shutdown)
        with pytest.raises(executors.ExternalShutdownException):
            rclpy.spin(node)

    simulate(program)
    offered, requested = told
    assert requested.calls == [(2500, 1, 1), (3500, 2, 1)]
    assert offered.calls == requested.calls


def test_a_message_at_the_moment_of_the_deadline_meets_it() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        events = SubscriptionEventCallbacks(deadline=lambda _: pytest.fail("it was met"))
        node.create_subscription(Int32, "t", hear, DEADLINE, event_callbacks=events)
        publisher = node.create_publisher(Int32, "t", DEADLINE)
        publish_at(simulation, publisher, *range(1, 6))
        simulation.at(5.5, rclpy.shutdown)
        with pytest.raises(executors.ExternalShutdownException):
            rclpy.spin(node)

    simulate(program)


def test_deadlines_missed_while_nobody_looks_are_told_together() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        told = Told(simulation, "total_count", "total_count_change")
        events = SubscriptionEventCallbacks(deadline=told)
        node.create_subscription(Int32, "t", hear, DEADLINE, event_callbacks=events)
        publisher = node.create_publisher(Int32, "t", DEADLINE)
        publisher.publish(Int32())
        simulation.sleep(3.5)
        publisher.publish(Int32())
        for _ in range(4):
            rclpy.spin_once(node, timeout_sec=0.0)
        assert told.calls == [(3500, 3, 3)]
        rclpy.spin_once(node, timeout_sec=2.0)
        assert told.calls[1:] == [(4500, 4, 1)]

    simulate(program)


def test_no_deadline_counts_before_the_first_message_or_without_one_in_the_profile() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def listen(qos: QoSProfile) -> None:
            events = SubscriptionEventCallbacks(deadline=lambda _: pytest.fail("no deadline was missed"))
            node.create_subscription(Int32, "t", hear, qos, event_callbacks=events)

        listen(QoSProfile(depth=1))
        node.create_publisher(Int32, "t", 1).publish(Int32())
        node.create_publisher(Int32, "other", DEADLINE)
        simulation.at(5.0, rclpy.shutdown)
        with pytest.raises(executors.ExternalShutdownException):
            rclpy.spin(node)

    simulate(program)


# Liveliness

LEASE = QoSProfile(
    depth=10, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, liveliness_lease_duration=within(1.0)
)
CHANGES = ("alive_count", "not_alive_count", "alive_count_change", "not_alive_count_change")


def liveliness(act: Callable[[Simulation, Publisher], object], qos: QoSProfile) -> tuple[Told, Told]:
    """What the publisher's and the subscription's sides hear in five seconds."""
    told: list[Told] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        lost, changed = Told(simulation, "total_count", "total_count_change"), Told(simulation, *CHANGES)
        told.extend((lost, changed))
        node.create_subscription(
            Int32, "t", hear, qos, event_callbacks=SubscriptionEventCallbacks(liveliness=changed)
        )
        publisher = node.create_publisher(
            Int32, "t", qos, event_callbacks=PublisherEventCallbacks(liveliness=lost)
        )
        act(simulation, publisher)
        simulation.at(5.0, rclpy.shutdown)
        with pytest.raises(executors.ExternalShutdownException):
            rclpy.spin(node)

    simulate(program)
    return told[0], told[1]


def test_a_publisher_that_does_not_say_that_it_lives_is_held_for_dead() -> None:
    lost, changed = liveliness(lambda at, publisher: publish_at(at, publisher, 0.5, 3.0), LEASE)
    assert changed.calls == [(0, 1, 0, 1, 0), (1500, 0, 1, -1, 1), (3000, 1, 0, 1, -1), (4000, 0, 1, -1, 1)]
    assert lost.calls == [(1500, 1, 1), (4000, 2, 1)]


def test_asserting_liveliness_is_as_good_as_publishing() -> None:
    def act(simulation: Simulation, publisher: Publisher) -> None:
        for time in (0.9, 1.8, 2.7, 3.6, 4.5):
            simulation.at(time, publisher.assert_liveliness)

    lost, changed = liveliness(act, LEASE)
    assert changed.calls == [(0, 1, 0, 1, 0)]
    assert not lost.calls


def test_by_default_a_publisher_lives_until_it_is_destroyed() -> None:
    qos = QoSProfile(depth=1, liveliness_lease_duration=within(1.0))
    lost, changed = liveliness(lambda simulation, publisher: simulation.at(3.0, publisher.destroy), qos)
    assert changed.calls == [(0, 1, 0, 1, 0), (3000, 0, 0, -1, 0)]
    assert not lost.calls


def test_a_dead_publisher_that_goes_is_counted_among_the_dead_no_more() -> None:
    _, changed = liveliness(lambda simulation, publisher: simulation.at(3.0, publisher.destroy), LEASE)
    assert changed.calls == [(0, 1, 0, 1, 0), (1000, 0, 1, -1, 1), (3000, 0, 0, 0, -1)]


# Lifespans

LIFESPAN = QoSProfile(depth=10, lifespan=within(1.0))


def test_messages_expire_in_the_queue_and_count_as_dropped() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_subscription(Int32, "t", hear, 10)
        publisher = node.create_publisher(Int32, "t", LIFESPAN)
        publish_at(simulation, publisher, 0.25, 0.5, 1.5)
        simulation.sleep(2.0)
        for _ in range(3):
            rclpy.spin_once(node, timeout_sec=0.0)

    trace = simulate(program)
    assert trace.times("hear") == [2.0]
    assert trace.drops("hear") == 2
    drops = [each for each in trace.events if type(each).__name__ == "MessageDropped"]
    assert [each.t / 1e9 for each in drops] == [1.25, 1.5]


def test_nobody_is_woken_for_what_has_expired() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_subscription(Int32, "t", hear, 10)
        node.create_publisher(Int32, "t", LIFESPAN).publish(Int32())
        simulation.sleep(1.0)
        rclpy.spin_once(node, timeout_sec=2.0)
        assert simulation.now == 3.0

    simulate(program)


def test_a_message_may_expire_between_hand_over_and_take() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        groups = [callback_groups.MutuallyExclusiveCallbackGroup() for _ in range(2)]
        node.create_timer(0.5, lambda: simulation.sleep(2.0), groups[0])
        node.create_subscription(Int32, "t", hear, 10, callback_group=groups[1])
        publisher = node.create_publisher(Int32, "t", LIFESPAN)
        publish_at(simulation, publisher, 0.75)
        with pytest.warns(UserWarning, match="used with a single thread"):
            executor = MultiThreadedExecutor(1)
        executor.add_node(node)
        executor.spin()

    trace = simulate(program, until=4.0)
    assert trace.times("hear") == []
    assert trace.drops("hear") == 1


def test_what_a_publisher_kept_for_late_subscriptions_expires() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        qos = QoSProfile(depth=10, lifespan=within(1.0), durability=DurabilityPolicy.TRANSIENT_LOCAL)
        publisher = node.create_publisher(Int32, "t", qos)
        publish_at(simulation, publisher, 0.25, 1.0)
        simulation.sleep(1.5)
        node.create_subscription(Int32, "t", hear, qos)
        for _ in range(3):
            rclpy.spin_once(node, timeout_sec=0.0)

    assert simulate(program).times("hear") == [1.5]
