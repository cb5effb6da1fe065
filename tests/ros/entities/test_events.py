"""Events of publishers and subscriptions: matches made, lost and refused; served before all else."""

from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message
from sim.ros.entities.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from sim.ros.logging import logger as logging
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSPolicyKind, QoSProfile, ReliabilityPolicy
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")
String = message("std_msgs", "String")
BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)


def drain(node: Node) -> None:
    for _ in range(4):
        rclpy.spin_once(node, timeout_sec=0.0)


def test_matches_are_told_with_their_changes_since_the_last_event() -> None:
    told: list[Any] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        events = PublisherEventCallbacks(matched=told.append, use_default_callbacks=False)
        publisher = node.create_publisher(Int32, "t", 10, event_callbacks=events)
        assert [each.callback for each in publisher.event_handlers] == [events.matched]
        first = node.create_subscription(Int32, "t", lambda _: None, 10)
        node.create_subscription(Int32, "t", lambda _: None, 10)
        drain(node)
        node.destroy_subscription(first)
        drain(node)

    simulate(program)
    assert [(i.total_count, i.total_count_change, i.current_count, i.current_count_change) for i in told] == [
        (2, 2, 2, 2),
        (2, 0, 1, -1),
    ]


def test_a_subscription_is_told_that_its_publisher_went() -> None:
    told: list[int] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        events = SubscriptionEventCallbacks(matched=lambda info: told.append(info.current_count))
        node.create_subscription(Int32, "t", lambda _: None, 10, event_callbacks=events)
        publisher = node.create_publisher(Int32, "t", 10)
        drain(node)
        publisher.destroy()
        drain(node)

    simulate(program)
    assert told == [1, 0]


def test_a_callback_for_incompatible_quality_takes_the_place_of_the_warning() -> None:
    told: list[Any] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        events = PublisherEventCallbacks(incompatible_qos=told.append)
        node.create_publisher(Int32, "t", BEST_EFFORT, event_callbacks=events)
        silent = SubscriptionEventCallbacks(use_default_callbacks=False)
        node.create_subscription(Int32, "t", lambda _: None, 10, event_callbacks=silent)
        drain(node)

    trace = simulate(program)
    assert [(i.total_count, i.last_policy_kind) for i in told] == [(1, QoSPolicyKind.RELIABILITY)]
    assert not trace.said()


def test_another_type_on_the_topic_is_told() -> None:
    told: list[int] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        events = SubscriptionEventCallbacks(incompatible_type=lambda info: told.append(info.total_count))
        node.create_subscription(Int32, "t", lambda _: None, 10, event_callbacks=events)
        node.create_publisher(String, "t", 10)
        drain(node)

    simulate(program)
    assert told == [1]


def test_events_of_every_node_come_before_the_timers_of_the_first() -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        first, second = Node("first"), Node("second")
        first.create_timer(0.1, lambda: order.append("timer"))
        events = SubscriptionEventCallbacks(matched=lambda _: order.append("matched"))
        second.create_subscription(Int32, "t", lambda _: order.append("message"), 10, event_callbacks=events)
        first.create_publisher(Int32, "t", 10).publish(Int32())
        simulation.sleep(0.15)
        executor = rclpy.get_global_executor()
        executor.add_node(first)
        executor.add_node(second)
        for _ in range(3):
            executor.spin_once(timeout_sec=0.0)

    trace = simulate(program)
    assert order == ["matched", "timer", "message"]
    assert len(trace.calls()) == 3


def test_warnings_without_a_callback_go_through_the_root_logger(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    class Root(logging.RcutilsLogger):
        def get_child(self, name: str) -> logging.RcutilsLogger:
            asked.append(name)
            return super().get_child(name)

    monkeypatch.setattr(logging, "_root_logger", Root())

    def program(simulation: Simulation) -> None:
        node = Node("listener")
        node.create_subscription(Int32, "t", lambda _: None, 10)
        simulation.outside_node().create_publisher(Int32, "t", BEST_EFFORT)
        drain(node)

    assert "incompatible QoS" in "".join(simulate(program).said())
    assert asked[-1] == "listener"
