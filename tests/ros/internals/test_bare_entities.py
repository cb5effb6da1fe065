"""What a program does by handles, without an executor: take, answer, wait for things and look at events."""

from typing import Any

import pytest

from sim.interfaces import message, service, to_cdr
from sim.ros.clocks.clock import Clock
from sim.ros.entities.event_handler import (
    QoSPublisherEventType,
    QoSSubscriptionEventType,
    SubscriptionEventCallbacks,
)
from sim.ros.entities.guard_condition import GuardCondition
from sim.ros.exceptions import InvalidHandle, RCLError
from sim.ros.internals import compiled as _rclpy
from sim.ros.node.node import Node
from sim.ros.qos.qos import LivelinessPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy
from sim.ros.scheduling.executors import SingleThreadedExecutor
from sim.ros.time.duration import Duration
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")
BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
QOS = QoSProfile(depth=10).get_c_qos_profile()
PUBLISHER = QoSPublisherEventType
SUBSCRIPTION = QoSSubscriptionEventType


def ignore(_message: object) -> None:
    pass


def wait_set_for(node: Node, **room: int) -> Any:
    kinds = ("subscriptions", "guards", "timers", "clients", "services", "events")
    arguments: list[Any] = [*(room.get(kind, 0) for kind in kinds), node.context.handle]
    return _rclpy.WaitSet(*arguments)


def test_a_message_is_taken_by_the_handle_with_its_info_as_message_or_as_bytes() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        plain = node.create_subscription(Int32, "t", ignore, 10)
        raw = node.create_subscription(Int32, "t", ignore, 10, raw=True)
        informed = node.create_subscription(Int32, "t", lambda _message, _info: None, 10)
        publisher = node.create_publisher(Int32, "t", 10)
        for number in (5, 6):
            publisher.publish(Int32(data=number))
        for each in (plain, raw, informed):
            handle: Any = each.handle
            first, info = handle.take_message(Int32, False)
            assert first == Int32(data=5)
            assert info["reception_sequence_number"] == info["publication_sequence_number"] == 1
            assert handle.take_message(Int32, True)[0] == to_cdr(Int32(data=6))
            assert handle.take_message(Int32, False) is None

    simulate(program)


def test_a_message_taken_by_the_handle_comes_to_no_callback() -> None:
    told: list[Any] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        subscription = node.create_subscription(Int32, "t", told.append, 10)
        publisher = node.create_publisher(Int32, "t", 10)
        for number in (5, 6):
            publisher.publish(Int32(data=number))
        subscription.handle.take_message(Int32, False)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        for _turn in range(3):
            executor.spin_once(timeout_sec=0)

    simulate(program)
    assert told == [Int32(data=6)]


@pytest.mark.parametrize("name_of_request", ["header", "id"])
def test_a_call_is_taken_and_answered_by_the_handles(name_of_request: str) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        server: Any = node.create_service(SetBool, "s", lambda _request, response: response).handle
        client: Any = node.create_client(SetBool, "s").handle
        assert client.service_server_is_available()
        assert server.service_take_request(SetBool.Request) == (None, None)
        sent = client.send_request(SetBool.Request(data=True))
        request, header = server.service_take_request(SetBool.Request)
        assert request == SetBool.Request(data=True)
        assert header.request_id.sequence_number == sent
        assert header.source_timestamp == header.received_timestamp > 0
        answered = header if name_of_request == "header" else header.request_id
        server.service_send_response(SetBool.Response(message="done"), answered)
        info, response = client.take_response(SetBool.Response)
        assert response == SetBool.Response(message="done")
        assert info.request_id.sequence_number == sent
        with pytest.raises(TypeError, match="the header or the id of a request"):
            server.service_send_response(SetBool.Response(), info)

    simulate(program)


def test_nothing_is_taken_by_the_handle_of_what_was_destroyed() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        subscription = node.create_subscription(Int32, "t", ignore, 10)
        subscription.destroy()
        with pytest.raises(InvalidHandle):
            subscription.handle.take_message(Int32, False)

    simulate(program)


def test_a_wait_set_waits_until_the_first_of_its_entities_is_ready() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        subscription = node.create_subscription(Int32, "t", ignore, 10)
        timer = node.create_timer(3.0, lambda: None)
        publisher = node.create_publisher(Int32, "t", 10)
        simulation.at(1.0, lambda: publisher.publish(Int32()))
        wait_set = wait_set_for(node, subscriptions=1, timers=1)
        with subscription.handle, timer.handle:
            message_index = wait_set.add_subscription(subscription.handle)
            timer_index = wait_set.add_timer(timer.handle)
        wait_set.wait()
        assert simulation.now == 1.0
        assert wait_set.is_ready("subscription", message_index)
        assert not wait_set.is_ready("timer", timer_index)
        assert wait_set.get_ready_entities("subscription") == [subscription.handle.pointer]
        subscription.handle.take_message(Int32, False)
        wait_set.wait(-1)
        assert simulation.now == 3.0
        assert wait_set.is_ready("timer", timer_index)
        assert not wait_set.is_ready("subscription", message_index)

    simulate(program)


def test_a_wait_set_gives_up_at_its_timeout() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        bare = _rclpy.Timer(Clock().handle, node.context.handle, 2_000_000_000)
        wait_set = wait_set_for(node, timers=1)
        index = wait_set.add_timer(bare)
        wait_set.wait(0)
        assert simulation.now == 0.0
        wait_set.wait(500_000_000)
        assert simulation.now == 0.5
        assert not wait_set.is_ready("timer", index)
        wait_set.wait(5_000_000_000)
        assert simulation.now == 2.0
        assert wait_set.is_ready("timer", index)

    simulate(program)


def test_a_wait_set_hears_of_a_timer_that_is_reset() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        timer = node.create_timer(2.0, lambda: None)
        timer.cancel()
        wait_set = wait_set_for(node, timers=1)
        wait_set.add_timer(timer.handle)
        simulation.at(1.0, timer.reset)
        wait_set.wait(9_000_000_000)
        assert simulation.now == 3.0

    simulate(program)


def test_a_wait_set_takes_the_flag_of_a_guard_condition_down() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        own = GuardCondition(None, None, context=node.context)
        of_node = node.create_guard_condition(None)
        assert isinstance(of_node, GuardCondition)
        wait_set = wait_set_for(node, guards=2)
        for each in (own, of_node):
            wait_set.add_guard_condition(each.handle)
        for index, each in enumerate((own, of_node)):
            simulation.at(1.0 + index, each.trigger)
            wait_set.wait()
            assert [wait_set.is_ready("guard_condition", other) for other in (0, 1)] == [
                index == 0,
                index == 1,
            ]
        wait_set.wait(0)
        assert wait_set.get_ready_entities("guard_condition") == []

    simulate(program)


def test_a_guard_condition_of_no_node_is_triggered_until_it_is_destroyed() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        with GuardCondition(callback=None, callback_group=None, context=node.context) as guard:
            guard.trigger()
        with pytest.raises(InvalidHandle):
            guard.trigger()
        with pytest.raises(InvalidHandle), guard.handle:
            pass

    simulate(program)


def test_a_wait_set_waits_for_nothing_only_with_an_error() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        wait_set = wait_set_for(node, guards=1)
        with pytest.raises(RCLError, match="wait set is empty"):
            wait_set.wait(0)
        guard = _rclpy.GuardCondition(node.context.handle)
        wait_set.add_guard_condition(guard)
        with pytest.raises(RCLError, match="guard_conditions set is full"):
            wait_set.add_guard_condition(guard)
        wait_set.clear_entities()
        assert wait_set.add_guard_condition(guard) == 0

    simulate(program)


def test_a_wait_set_refuses_what_an_executor_serves() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        subscription = node.create_subscription(Int32, "t", ignore, 10)
        wait_set = wait_set_for(node, subscriptions=1)
        wait_set.add_subscription(subscription.handle)
        executor = SingleThreadedExecutor()
        simulation.at(1.0, lambda: executor.add_node(node))
        with pytest.raises(NotImplementedError, match="WaitSet"):
            wait_set.wait()
        assert simulation.now == 1.0

    simulate(program)


def test_an_event_of_nothing_that_happened_counts_nought() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(Int32, "t", 10)
        subscription = node.create_subscription(Int32, "other", ignore, 10)
        events = [_rclpy.EventHandle(publisher.handle, each) for each in QoSPublisherEventType]
        events += [_rclpy.EventHandle(subscription.handle, each) for each in QoSSubscriptionEventType]
        wait_set = wait_set_for(node, events=len(events))
        for each in events:
            with each:
                wait_set.add_event(each)
        wait_set.wait(0)
        assert wait_set.get_ready_entities("event") == []
        assert [each.take_event() for each in events] == [type(each.info)() for each in events]
        for each in events:
            each.destroy_when_not_in_use()
            with pytest.raises(InvalidHandle):
                each.take_event()

    simulate(program)


def test_an_event_is_waited_for_and_its_changes_count_anew_once_taken() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(Int32, "t", 10)
        node.create_subscription(Int32, "t", ignore, 10)
        matched = _rclpy.EventHandle(publisher.handle, PUBLISHER.RCL_PUBLISHER_MATCHED)
        first = matched.take_event()
        assert (first.total_count, first.current_count_change) == (1, 1)
        wait_set = wait_set_for(node, events=1)
        index = wait_set.add_event(matched)
        simulation.at(1.0, lambda: node.create_subscription(Int32, "t", ignore, 10))
        wait_set.wait()
        assert simulation.now == 1.0
        assert wait_set.is_ready("event", index)
        info = matched.take_event()
        assert (info.total_count, info.total_count_change, info.current_count) == (2, 1, 2)
        wait_set.wait(0)
        assert not wait_set.is_ready("event", index)

    simulate(program)


def test_a_refused_match_is_counted_beside_the_callback_for_it() -> None:
    told: list[Any] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        callbacks = SubscriptionEventCallbacks(incompatible_qos=told.append)
        subscription = node.create_subscription(Int32, "t", ignore, 10, event_callbacks=callbacks)
        kind = SUBSCRIPTION.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS
        refused = _rclpy.EventHandle(subscription.handle, kind)
        node.create_publisher(Int32, "t", BEST_EFFORT)
        told.append(refused.take_event())
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin_once(timeout_sec=0)

    simulate(program)
    assert [each.last_policy_kind for each in told] == [QoSPolicyKind.RELIABILITY] * 2


def test_liveliness_counts_the_publishers_as_long_as_none_has_a_lease() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(Int32, "t", 10)
        subscription = _rclpy.Subscription(node.handle, Int32, "t", QOS)
        event = _rclpy.EventHandle(subscription, SUBSCRIPTION.RCL_SUBSCRIPTION_LIVELINESS_CHANGED)
        assert event.take_event().alive_count == 1
        publisher.destroy()
        info = event.take_event()
        assert (info.alive_count, info.alive_count_change) == (0, -1)
        leased = QoSProfile(
            depth=10,
            liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
            liveliness_lease_duration=Duration(seconds=1),
        )
        leaving = node.create_publisher(Int32, "t", leased)
        lost = PUBLISHER.RCL_PUBLISHER_LIVELINESS_LOST
        with pytest.raises(NotImplementedError, match="EventHandle"):
            event.take_event()
        with pytest.raises(NotImplementedError, match="EventHandle"):
            _rclpy.EventHandle(leaving.handle, lost)

    simulate(program)


def test_an_event_of_a_deadline_that_is_set_is_refused() -> None:
    def program(_: Simulation) -> None:
        profile = QoSProfile(depth=10, deadline=Duration(seconds=1))
        publisher = Node("n").create_publisher(Int32, "t", profile)
        with pytest.raises(NotImplementedError, match="EventHandle"):
            _rclpy.EventHandle(publisher.handle, PUBLISHER.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED)
        with pytest.raises(TypeError, match="Publisher has no event"):
            _rclpy.EventHandle(publisher.handle, SUBSCRIPTION.RCL_SUBSCRIPTION_MATCHED)

    simulate(program)


def test_every_callback_for_events_has_its_handler() -> None:
    def program(_: Simulation) -> None:
        callbacks = SubscriptionEventCallbacks(deadline=ignore, liveliness=ignore, message_lost=ignore)
        subscription = Node("n").create_subscription(Int32, "t", ignore, 10, event_callbacks=callbacks)
        assert len(subscription.event_handlers) == 5

    simulate(program)
