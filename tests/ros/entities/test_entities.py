"""What programs can ask of publishers, subscriptions, services and clients, and what they give them."""

from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.ros.entities.publisher import Publisher
from sim.ros.entities.serialization import serialize_message
from sim.ros.exceptions import InvalidHandle
from sim.ros.node.node import Node
from sim.ros.node.qos_overriding_options import QoSOverridingOptions
from sim.ros.qos.qos import QoSProfile
from sim.ros.rclpy._entities.wait_for_message import wait_for_message
from sim.trace.events import MessageDropped
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")


def test_names_are_kept_as_written_and_told_in_full() -> None:
    def program(_: Simulation) -> None:
        node = Node("n", namespace="/ns")
        publisher = node.create_publisher(Int32, "t", 10)
        subscription = node.create_subscription(Int32, "~/t", lambda _: None, 10)
        offered = node.create_service(SetBool, "s", lambda _, response: response)
        client = node.create_client(SetBool, "s")
        assert (publisher.topic, publisher.topic_name) == ("t", "/ns/t")
        assert (subscription.topic, subscription.topic_name) == ("~/t", "/ns/n/t")
        assert (
            (offered.srv_name, offered.service_name)
            == (client.srv_name, client.service_name)
            == ("s", "/ns/s")
        )
        for each in (publisher, subscription, offered, client):
            assert each.logger_name == "ns.n"

    simulate(program)


def test_a_handle_demands_that_its_entity_lives() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        timer = node.create_timer(1.0, lambda: None)
        with timer.handle, node.handle:
            pass
        assert not node.destroyed
        with timer:
            assert list(node.timers) == [timer]
        assert not list(node.timers)
        with pytest.raises(InvalidHandle, match="destruction was requested"), timer.handle:
            pass

    simulate(program, distro="kilted")


def test_a_subscription_may_ask_for_the_info_of_a_message() -> None:
    heard: list[Any] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_subscription(Int32, "t", lambda msg, info: heard.append((msg.data, info)), 10)
        publisher = node.create_publisher(Int32, "t", 10)
        publisher.publish(Int32(data=1))
        simulation.sleep(0.5)
        publisher.publish(Int32(data=2))
        for _ in range(3):
            rclpy.spin_once(node, timeout_sec=0.0)

    simulate(program)
    first, second = (info for _, info in heard)
    assert [data for data, _ in heard] == [1, 2]
    assert second["source_timestamp"] - first["source_timestamp"] == 500_000_000
    assert second["received_timestamp"] == first["received_timestamp"] == second["source_timestamp"]
    assert (second["publication_sequence_number"], second["reception_sequence_number"]) == (2, 2)


def test_a_subscriptions_callback_takes_one_argument_or_two() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        with pytest.raises(RuntimeError, match=r"callable with one argument\(|callable with one argument"):
            node.create_subscription(Int32, "t", lambda: None, 10)
        subscription = node.create_subscription(Int32, "t", print, 10)
        with pytest.raises(RuntimeError):
            subscription.callback = lambda a, b, c: None

    simulate(program)


def test_raw_subscriptions_hear_bytes_and_bytes_can_be_published() -> None:
    heard: list[Any] = []
    data = serialize_message(Int32(data=7))

    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_subscription(Int32, "t", heard.append, 10, raw=True)
        node.create_subscription(Int32, "t", heard.append, 10)
        publisher = node.create_publisher(Int32, "t", 10)
        publisher.publish(data)
        for _number in range(2):
            rclpy.spin_once(node, timeout_sec=0.0)
        publisher.publish(b"junk")
        for _number in range(4):
            rclpy.spin_once(node, timeout_sec=0.0)

    assert len(simulate(program).of(MessageDropped)) == 1
    assert heard == [data, Int32(data=7), b"junk"]


def test_what_is_no_type_of_message_or_service_is_refused() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        with pytest.raises(RuntimeError, match="might be a service or action"):
            node.create_publisher(SetBool, "t", 10)
        with pytest.raises(AttributeError, match="has no attribute '_TYPE_SUPPORT'"):
            node.create_subscription(int, "t", print, 10)
        with pytest.raises(RuntimeError, match="might be a message or action"):
            node.create_client(Int32, "s")

    simulate(program)


def test_a_program_may_bring_its_own_class_of_publisher() -> None:
    class Counting(Publisher):
        count = 0

        def publish(self, msg: Any) -> None:
            self.count += 1
            super().publish(msg)

    def program(_: Simulation) -> None:
        publisher = Node("n").create_publisher(Int32, "t", 10, publisher_class=Counting)
        publisher.publish(Int32())
        assert isinstance(publisher, Counting)
        assert publisher.count == 1
        assert publisher.wait_for_all_acked()

    simulate(program)


def test_quality_of_service_is_overridden_where_the_program_allows_it() -> None:
    def program(_: Simulation) -> None:
        arguments = ["--ros-args", "-p", "qos_overrides./t.subscription.depth:=2"]
        node = Node("n", cli_args=arguments)
        options = QoSOverridingOptions.with_default_policies()
        subscription = node.create_subscription(Int32, "t", print, 10, qos_overriding_options=options)
        assert subscription.qos_profile == QoSProfile(depth=2)

    simulate(program)


def test_one_message_is_waited_for_without_spinning() -> None:
    def program(simulation: Simulation) -> None:
        simulation.publisher_at_rate("t", period=1.0, offset=2.0)
        node = Node("n")
        assert wait_for_message(Int32, node, "t", time_to_wait=1.0) == (False, None)
        assert wait_for_message(Int32, node, "t") == (True, Int32(data=0))
        assert simulation.now == 2.0
        assert not list(node.subscriptions)

    simulate(program, until=10.0)


def test_waiting_for_a_message_ends_with_the_context() -> None:
    def program(simulation: Simulation) -> None:
        simulation.at(1.0, rclpy.shutdown)
        assert wait_for_message(Int32, Node("n"), "t") == (False, None)
        assert simulation.now == 1.0

    simulate(program)
