"""Nodes with a life cycle."""

from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.ros.exceptions import RCLError
from sim.ros.lifecycle import (
    LifecycleNode,
    LifecycleState,
    ManagedEntity,
    SimpleManagedEntity,
    TransitionCallbackReturn,
)
from sim.ros.node.node import Node
from sim.ros.rclpy import executors
from tests.support.simulation import Simulation, simulate

SUCCESS, FAILURE, ERROR = TransitionCallbackReturn
Int32: Any = message("std_msgs", "Int32")
GetState, ChangeState, GetAvailableStates, GetAvailableTransitions = (
    service("lifecycle_msgs", name)
    for name in ("GetState", "ChangeState", "GetAvailableStates", "GetAvailableTransitions")
)


def state(node: LifecycleNode) -> str:
    """The label of the node's state."""
    return node._state_machine.current_state[1]


def test_a_node_goes_through_its_life() -> None:
    def program(_: Simulation) -> None:
        node = LifecycleNode("n")
        assert state(node) == "unconfigured"
        for trigger, reached in (
            (node.trigger_configure, "inactive"),
            (node.trigger_activate, "active"),
            (node.trigger_deactivate, "inactive"),
            (node.trigger_cleanup, "unconfigured"),
            (node.trigger_shutdown, "finalized"),
        ):
            assert trigger() is SUCCESS
            assert state(node) == reached

    simulate(program)


def test_a_way_that_does_not_lead_out_of_the_state_is_refused() -> None:
    def program(_: Simulation) -> None:
        node = LifecycleNode("n")
        with pytest.raises(RCLError, match="current state unconfigured"):
            node.trigger_activate()
        node.trigger_shutdown()
        for trigger in (node.trigger_configure, node.trigger_cleanup, node.trigger_shutdown):
            with pytest.raises(RCLError):
                trigger()
        assert state(node) == "finalized"

    simulate(program)


class Reporting(LifecycleNode):
    """Returns what it was made with, and notes what it was asked."""

    def __init__(self, on_way: Any, on_error: Any = SUCCESS) -> None:
        super().__init__("n")
        self.on_way = on_way
        self.after_error = on_error
        self.asked: list[tuple[str, LifecycleState]] = []

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        self.asked.append(("configure", state))
        if isinstance(self.on_way, Exception):
            raise self.on_way
        assert isinstance(self.on_way, TransitionCallbackReturn)
        return self.on_way

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        self.asked.append(("error", state))
        assert isinstance(self.after_error, TransitionCallbackReturn)
        return self.after_error


@pytest.mark.parametrize(
    ("on_way", "on_error", "outcome", "reached", "asked"),
    [
        (SUCCESS, SUCCESS, SUCCESS, "inactive", ["configure"]),
        (FAILURE, SUCCESS, FAILURE, "unconfigured", ["configure"]),
        (ERROR, SUCCESS, ERROR, "unconfigured", ["configure", "error"]),
        (ERROR, FAILURE, ERROR, "finalized", ["configure", "error"]),
        (ERROR, ERROR, ERROR, "finalized", ["configure", "error"]),
        (ValueError("broken"), SUCCESS, ERROR, "unconfigured", ["configure", "error"]),
    ],
)
def test_what_a_callback_returns_decides_where_the_node_goes(
    on_way: Any, on_error: Any, outcome: Any, reached: str, asked: list[str]
) -> None:
    def program(_: Simulation) -> None:
        node = Reporting(on_way, on_error)
        assert node.trigger_configure() is outcome
        assert state(node) == reached
        assert node.asked == [(each, LifecycleState("unconfigured", 1)) for each in asked]

    trace = simulate(program)
    said = (
        [] if outcome is on_way else ["the callback for the state 'configuring' raised ValueError('broken')"]
    )
    assert trace.said() == said


def test_a_lifecycle_publisher_is_silent_unless_its_node_is_active() -> None:
    heard: list[int] = []

    def program(_: Simulation) -> None:
        node = LifecycleNode("n")
        publisher = node.create_lifecycle_publisher(Int32, "t", 10)
        node.create_subscription(Int32, "t", lambda message: heard.append(message.data), 10)
        publisher.publish(Int32(data=1))
        node.trigger_configure()
        node.trigger_activate()
        assert publisher.is_activated
        publisher.publish(Int32(data=2))
        node.trigger_deactivate()
        publisher.publish(Int32(data=3))
        for _each in range(4):
            rclpy.spin_once(node, timeout_sec=0.0)
        assert node.destroy_lifecycle_publisher(publisher)

    simulate(program)
    assert heard == [2]


def test_a_managed_entity_can_stop_the_node() -> None:
    class Refusing(ManagedEntity):
        def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
            return FAILURE

    class Forgetful(ManagedEntity):
        def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
            return None  # type: ignore[return-value]

    def program(_: Simulation) -> None:
        node = LifecycleNode("n")
        node.add_managed_entity(Refusing())
        node.trigger_configure()
        assert node.trigger_activate() is FAILURE
        assert state(node) == "inactive"
        forgetful = LifecycleNode("m")
        forgetful.add_managed_entity(Forgetful())
        assert forgetful.trigger_configure() is ERROR

    assert any("should return a TransitionCallbackReturn" in each for each in simulate(program).said())


def test_a_decorated_method_works_only_while_enabled() -> None:
    class Worker(SimpleManagedEntity):
        @SimpleManagedEntity.when_enabled
        def work(self, amount: int) -> int:
            return amount

        @SimpleManagedEntity.when_enabled(when_not_enabled=lambda: -1)
        def rest(self) -> int:
            return 1

    worker = Worker()
    assert (worker.work(3), worker.rest()) == (None, -1)
    worker.on_activate(LifecycleState("inactive", 2))
    assert (worker.work(3), worker.rest()) == (3, 1)


def test_others_follow_and_steer_a_node_through_its_services() -> None:
    def program(_: Simulation) -> None:
        node, caller = LifecycleNode("n"), Node("caller")
        executor = executors.SingleThreadedExecutor()
        for each in (node, caller):
            executor.add_node(each)

        def ask(srv_type: Any, name: str, request: Any = None) -> Any:
            client = caller.create_client(srv_type, f"/n/{name}")
            future = client.call_async(srv_type.Request() if request is None else request)
            executor.spin_until_future_complete(future, timeout_sec=1.0)
            return future.result()

        def change(**transition: Any) -> bool:
            request = ChangeState.Request()
            for field, value in transition.items():
                setattr(request.transition, field, value)
            return bool(ask(ChangeState, "change_state", request).success)

        assert ask(GetState, "get_state").current_state.label == "unconfigured"
        assert change(id=1)
        assert change(label="activate")
        assert not change(label="configure")
        with pytest.raises(RCLError, match="Transition is not registered"):
            change(id=1)
        assert ask(GetState, "get_state").current_state.label == "active"
        assert len(ask(GetAvailableStates, "get_available_states").available_states) == 11
        ways = ask(GetAvailableTransitions, "get_available_transitions").available_transitions
        assert [(each.transition.label, each.goal_state.label) for each in ways] == [
            ("deactivate", "deactivating"),
            ("shutdown", "shuttingdown"),
        ]
        graph = ask(GetAvailableTransitions, "get_transition_graph").available_transitions
        assert len(graph) == 25

    simulate(program)


def test_every_step_is_told_to_a_listener() -> None:
    heard: list[Any] = []

    def program(_: Simulation) -> None:
        node, listener = LifecycleNode("n"), Node("listener")
        listener.create_subscription(
            message("lifecycle_msgs", "TransitionEvent"), "/n/transition_event", heard.append, 10
        )
        node.trigger_configure()
        for _each in range(4):
            rclpy.spin_once(listener, timeout_sec=0.0)

    simulate(program)
    assert [(each.start_state.label, each.goal_state.label) for each in heard] == [
        ("unconfigured", "configuring"),
        ("configuring", "inactive"),
    ]
    assert {(each.timestamp, each.transition.id, each.transition.label) for each in heard} == {(0, 0, "")}


def test_a_node_may_live_without_services() -> None:
    def program(_: Simulation) -> None:
        node = LifecycleNode("n", enable_communication_interface=False)
        assert not any("state" in each.srv_name for each in node.services)
        assert node.trigger_configure() is SUCCESS

    simulate(program)
