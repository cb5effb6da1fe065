"""Waitables that a program writes: what they may wait for, and what they are held to."""

from collections.abc import Callable

import pytest

from sim.ros.clocks.clock import Clock
from sim.ros.exceptions import InvalidHandle, RCLError
from sim.ros.internals import compiled as _rclpy
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import (
    ReentrantCallbackGroup,
)
from sim.ros.scheduling.executors import Executor, SingleThreadedExecutor
from sim.ros.scheduling.program_wait_set import ProgramWaitSet
from sim.ros.scheduling.task import Future
from sim.ros.scheduling.waitable import NumberOfEntities, Waitable
from sim.ros.time.clock_type import ClockType
from tests.ros.scheduling.waitables import (
    QOS,
    Empty,
    EmptySrv,
    Flag,
    Waiting,
    every_executor,
    served,
)
from tests.support.simulation import Simulation, simulate


def test_counts_of_entities_add_up() -> None:
    total = NumberOfEntities(1, num_events=2) + NumberOfEntities(3, 4)
    assert total == NumberOfEntities(num_subscriptions=4, num_guard_conditions=4, num_events=2)


@every_executor
def test_a_waitable_may_wait_for_a_response(make: Callable[[], Executor]) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        with node.handle:
            client = _rclpy.Client(node.handle, EmptySrv, "serve", QOS)
        assert not client.service_server_is_available()
        outside = simulation.outside_node()
        outside.create_service(EmptySrv, "serve", lambda _request, response: response)
        simulation.spin_outside(outside)
        assert client.service_server_is_available()
        sent = []
        simulation.at(1.0, lambda: sent.append(client.send_request(EmptySrv.Request())))
        waitable = Waiting("client", client, lambda each: each.take_response(EmptySrv.Response))
        header, response = served(make, node, waitable)
        assert isinstance(response, EmptySrv.Response)
        assert [header.request_id.sequence_number] == sent
        assert client.take_response(EmptySrv.Response) == (None, None)

    simulate(program)


@every_executor
def test_a_waitable_may_wait_for_a_request_and_answer_it(make: Callable[[], Executor]) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        with node.handle:
            server = _rclpy.Service(node.handle, EmptySrv, "serve", QOS)
        client = node.create_client(EmptySrv, "serve")
        simulation.at(1.0, lambda: client.call_async(EmptySrv.Request()))
        waitable = Waiting("service", server, lambda each: each.service_take_request(EmptySrv.Request))
        request, header = served(make, node, waitable)
        assert isinstance(request, EmptySrv.Request)
        server.service_send_response(EmptySrv.Response(), header)
        assert client.pending

    simulate(program)


@every_executor
def test_a_waitable_may_wait_for_a_message(make: Callable[[], Executor]) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        with node.handle:
            subscription = _rclpy.Subscription(node.handle, Empty, "t", QOS)
        publisher = node.create_publisher(Empty, "t", 1)
        simulation.at(1.0, lambda: publisher.publish(Empty()))
        waitable = Waiting("subscription", subscription, lambda each: each.take_message(Empty, False)[0])
        assert isinstance(served(make, node, waitable), Empty)
        assert simulation.now == 1.0
        assert subscription.take_message(Empty, False) is None
        assert publisher.get_subscription_count() == 1
        subscription.destroy()
        assert publisher.get_subscription_count() == 0

    simulate(program)


@every_executor
def test_a_waitable_may_wait_for_a_timer(make: Callable[[], Executor]) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        with clock.handle, node.context.handle:
            timer = _rclpy.Timer(clock.handle, node.context.handle, 10_000, True)
        served(make, node, Waiting("timer", timer, lambda each: each.call_timer()))
        assert simulation.now == 10e-6
        assert timer.time_until_next_call() == 10_000

    simulate(program)


@every_executor
def test_a_waitable_may_wait_for_a_guard_condition(make: Callable[[], Executor]) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        with node.context.handle:
            guard = _rclpy.GuardCondition(node.context.handle)
        simulation.at(1.0, guard.trigger_guard_condition)
        served(make, node, Waiting("guard_condition", guard, lambda _: None))
        assert simulation.now == 1.0

    simulate(program)


def test_a_waitable_may_wait_for_an_entity_of_its_node_that_has_its_own_callback_too() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        guard = node.create_guard_condition(lambda: None)
        simulation.at(1.0, guard.trigger)
        served(SingleThreadedExecutor, node, Waiting("guard_condition", guard.handle, lambda _: None))
        assert simulation.now == 1.0

    simulate(program)


def test_futures_added_to_a_waitable_belong_to_its_executor() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        ran: list[str] = []
        flag = Flag(node.default_callback_group, ran)
        future: Future[int] = Future()
        other: Future[int] = Future()
        flag.add_future(future)
        flag.add_future(other)
        flag.remove_future(other)
        with pytest.raises(ValueError, match="not in list"):
            flag.remove_future(other)
        flag.waiting.append("waitable")
        node.add_waitable(flag)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin_once(timeout_sec=0)
        future.add_done_callback(lambda _: ran.append("as a task"))
        other.add_done_callback(lambda _: ran.append("at once"))
        future.set_result(1)
        other.set_result(1)
        assert ran == ["waitable", "at once"]
        executor.spin_once(timeout_sec=0)  # ends the cycle of the waitable
        executor.spin_once(timeout_sec=0)
        assert ran == ["waitable", "at once", "as a task"]

    simulate(program)


def test_a_waitable_whose_entities_are_gone_is_left_out_of_the_cycle() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        class Gone(Flag):
            def __enter__(self) -> None:
                raise InvalidHandle

        flag = Gone(node.default_callback_group, [])
        flag.waiting.append("x")
        node.add_waitable(flag)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin_once(timeout_sec=0.1)
        assert flag.asked == 0
        assert simulation.now == 0.1

    simulate(program)


def test_a_nodes_waitables_are_listed_and_removed() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        flag = Flag(node.default_callback_group, [])
        before = list(node.waitables)
        node.add_waitable(flag)
        assert node.default_callback_group.has_entity(flag)
        assert list(node.waitables) == [*before, flag]
        node.remove_waitable(flag)
        assert list(node.waitables) == before
        with pytest.raises(ValueError, match="was not added"):
            node.remove_waitable(flag)
        node.add_waitable(flag)
        node.destroy_node()
        assert list(node.waitables) == []

    simulate(program)


def test_more_entities_than_announced_are_refused() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        guard = _rclpy.GuardCondition(node.context.handle)

        class Greedy(Waiting):
            def get_num_entities(self) -> NumberOfEntities:
                return NumberOfEntities()

        node.add_waitable(Greedy("guard_condition", guard, lambda _: None))
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        with pytest.raises(RCLError, match="Failed to add 'guard_condition' to wait set"):
            executor.spin_once(timeout_sec=0)

    simulate(program)


@pytest.mark.parametrize("method", ["is_ready", "take_data", "get_num_entities", "add_to_wait_set"])
def test_a_waitable_must_say_everything_itself(method: str) -> None:
    def program(simulation: Simulation) -> None:
        waitable: Waitable[None] = Waitable(ReentrantCallbackGroup())
        arguments = [ProgramWaitSet(NumberOfEntities())] if method in {"is_ready", "add_to_wait_set"} else []
        with pytest.raises(NotImplementedError, match="Must be implemented by subclass"):
            getattr(waitable, method)(*arguments)

    simulate(program)


def test_a_node_without_waitables_is_not_asked() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        flag = Flag(node.default_callback_group, [])
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        assert not executor._polls_waitables
        asks = []
        changes = (node.add_waitable, node.remove_waitable, node.add_waitable)
        for change in changes:
            change(flag)
            asks.append(executor._polls_waitables)
        executor.remove_node(node)
        assert [*asks, executor._polls_waitables] == [True, False, True, False]

    simulate(program)
