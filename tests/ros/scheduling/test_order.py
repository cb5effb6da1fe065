"""The order in which one snapshot of the wait set is served, and what goes before it."""

from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.clock.strategies import PctSchedule
from sim.interfaces import message, service
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from sim.trace.events import CallbackStarted, EntityAppeared
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")


def make_everything(node: Node, order: list[str], topic: str) -> None:
    """One entity of each kind, made in the reverse of the order of service, each ready after one second."""
    name = node.get_name()

    def said(what: str) -> None:
        order.append(f"{name} {what}")

    def serve(_request: object, response: object) -> object:
        said("service")
        return response

    client = node.create_client(SetBool, f"other_{name}")
    node.create_service(SetBool, f"own_{name}", serve)
    guard = node.create_guard_condition(lambda: said("guard"))
    node.create_subscription(Int32, topic, lambda _: said("subscription 1"), 10)
    node.create_subscription(Int32, topic, lambda _: said("subscription 2"), 10)
    node.create_timer(1.0, lambda: said("timer 1"))
    node.create_timer(0.9, lambda: said("timer 2"))
    future = client.call_async(SetBool.Request())
    future.add_done_callback(lambda _: said("client"))
    node.create_client(SetBool, f"own_{name}").call_async(SetBool.Request())
    node.create_publisher(Int32, topic, 10).publish(Int32())
    guard.trigger()


def test_kinds_are_served_in_rclpys_order_and_within_a_kind_the_oldest_first_and_node_by_node() -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        outside = simulation.outside_node()
        for name in "ab":
            outside.create_service(SetBool, f"other_{name}", lambda _, response: response)
        nodes = [Node("a"), Node("b")]
        for node in nodes:
            make_everything(node, order, f"topic_{node.get_name()}")
        simulation.spin_outside(outside)
        simulation.sleep(1.0)
        executor = SingleThreadedExecutor()
        for node in nodes:
            executor.add_node(node)
        while len(order) < 14:
            executor.spin_once(timeout_sec=0)

    simulate(program, until=1.5)
    kinds = ["timer 1", "timer 2", "subscription 1", "subscription 2", "guard", "service"]
    served = [each for each in order if "client" not in each]
    assert served == [f"{name} {kind}" for name in "ab" for kind in kinds]


def test_a_client_is_served_after_guards_and_before_services() -> None:
    def program(simulation: Simulation) -> None:
        outside = simulation.outside_node()
        outside.create_service(SetBool, "other", lambda _, response: response)
        simulation.spin_outside(outside)
        node = Node("n")
        node.create_service(SetBool, "own", lambda _, response: response)
        client = node.create_client(SetBool, "other")
        guard = node.create_guard_condition(lambda: None)
        client.call_async(SetBool.Request())
        outside.create_client(SetBool, "own").call_async(SetBool.Request())
        guard.trigger()
        simulation.sleep(1.0)
        rclpy.spin(node)

    trace = simulate(program, until=2.0)
    kinds = {each.entity: str(each.kind) for each in trace.of(EntityAppeared)}
    assert [kinds[each.entity] for each in trace.of(CallbackStarted)] == ["guard", "client", "service"]


def test_messages_queued_on_two_topics_are_served_by_turns() -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        for topic in "ab":
            node.create_subscription(Int32, topic, _appending(order, topic), 10)
            publisher = node.create_publisher(Int32, topic, 10)
            for _ in range(5):
                publisher.publish(Int32())
        rclpy.spin(node)

    simulate(program, until=0.1)
    assert order == ["a", "b"] * 5


def test_what_becomes_ready_during_a_snapshot_waits_for_the_next() -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: order.append("timer"))

        def work() -> None:
            order.append("first")
            simulation.sleep(1.0)

        first = node.create_guard_condition(work)
        second = node.create_guard_condition(lambda: order.append("second"))
        first.trigger()
        second.trigger()
        rclpy.spin(node)

    simulate(program, until=1.5)
    assert order == ["first", "second", "timer"]


def test_a_timer_that_is_no_longer_due_when_its_turn_comes_is_passed_over() -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = SingleThreadedExecutor()
        executor.add_node(node)

        def put_off() -> None:
            order.append("first")
            second.reset()

        node.create_timer(1.0, put_off)
        second = node.create_timer(1.0, lambda: order.append("second"))
        executor.spin()

    simulate(program, until=2.5)
    assert order == ["first", "first"]


def test_a_subscription_destroyed_before_its_turn_is_passed_over() -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def remove_other(_: object) -> None:
            order.append("a")
            node.destroy_subscription(other)

        node.create_subscription(Int32, "t", remove_other, 10)
        other = node.create_subscription(Int32, "t", lambda _: order.append("b"), 10)
        node.create_publisher(Int32, "t", 10).publish(Int32())
        rclpy.spin(node)

    simulate(program, until=1.0)
    assert order == ["a"]


@pytest.mark.parametrize(("distro", "tasks"), [("jazzy", "21"), ("kilted", "12")])
@pytest.mark.parametrize("make", [SingleThreadedExecutor, lambda: MultiThreadedExecutor(2)])
def test_tasks_go_before_entities_in_the_order_of_the_release(
    make: type[Executor], distro: str, tasks: str
) -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = make()
        executor.add_node(node)
        node.create_guard_condition(lambda: order.append("guard")).trigger()
        executor.create_task(order.append, "task 1")
        executor.create_task(lambda: order.append("task 2"))
        executor.spin()

    simulate(program, until=1.0, distro=distro)
    assert order == [*(f"task {each}" for each in tasks), "guard"]


def test_a_task_made_by_a_task_waits_until_what_is_ready_has_been_served() -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        guard = node.create_guard_condition(lambda: order.append("guard"))

        def work(left: int) -> None:
            order.append(f"task {left}")
            simulation.sleep(1.0)
            guard.trigger()
            if left:
                executor.create_task(work, left - 1)

        executor.create_task(work, 2)
        executor.spin()

    simulate(program, until=10.0)
    assert order == ["task 2", "guard", "task 1", "guard", "task 0", "guard"]


def test_a_message_is_taken_when_the_handler_runs_and_not_when_it_was_handed_out() -> None:
    """One worker: while it is busy the queue of depth 1 gets a newer message than the one handed out."""
    heard: list[int] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()
        guard = node.create_guard_condition(lambda: simulation.sleep(5.0), group)
        node.create_subscription(Int32, "t", lambda m: heard.append(m.data), 1, callback_group=group)
        publisher = node.create_publisher(Int32, "t", 10)
        for number, at in enumerate((1.0, 2.0, 3.0)):
            simulation.at(at, partial(publisher.publish, Int32(data=number)))
        guard.trigger()
        executor = MultiThreadedExecutor(1)
        executor.add_node(node)
        executor.spin()

    with pytest.warns(UserWarning, match="single thread"):
        simulate(program, until=6.0)
    assert heard == [2]


def test_entities_handed_out_wait_in_the_pool_once_each() -> None:
    """Both workers are busy: of a reentrant subscription's three messages one handler waits in the pool."""
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()
        guards = [node.create_guard_condition(lambda: simulation.sleep(2.0), group) for _ in range(2)]
        for topic in "ab":
            node.create_subscription(Int32, topic, _appending(order, topic), 10, callback_group=group)
        publishers = {topic: node.create_publisher(Int32, topic, 10) for topic in "ab"}
        for topic, at in (("a", 0.5), ("a", 0.6), ("a", 0.7), ("b", 1.0)):
            simulation.at(at, partial(publishers[topic].publish, Int32()))
        for guard in guards:
            guard.trigger()
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()

    simulate(program, until=3.0)
    assert order[:2] == ["a", "b"]
    assert sorted(order) == ["a", "a", "a", "b"]


def _appending(to: list[str], text: str) -> Callable[[object], None]:
    return lambda _: to.append(text)


def test_a_request_goes_to_every_server_of_its_name_and_the_first_reply_counts() -> None:
    served: list[str] = []

    def program(simulation: Simulation) -> None:
        nodes = Node("n"), Node("m")
        executor = SingleThreadedExecutor()
        for node in nodes:
            node.create_service(SetBool, "s", _serving(served, node.get_name()))
            executor.add_node(node)
        client = nodes[1].create_client(SetBool, "s")
        future: Any = client.call_async(SetBool.Request())
        executor.spin_until_future_complete(future)
        assert future.result().message == "n"
        executor.spin_once(timeout_sec=0.1)

    simulate(program)
    assert served == ["n", "m"]


def _serving(served: list[str], name: str) -> Callable[[Any, Any], Any]:
    def serve(request: Any, response: Any) -> Any:
        assert not request.data
        request.data = True  # everyone has a request of his own
        served.append(name)
        response.message = name
        return response

    return serve


def test_either_of_two_arrivals_at_an_idle_executor_may_come_first() -> None:
    heard: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        for topic in "ab":
            node.create_subscription(Int32, topic, lambda _, topic=topic: heard.append(topic), 10)
        publishers = [node.create_publisher(Int32, topic, 10) for topic in "ba"]

        def publish() -> None:
            for _ in range(19):
                simulation.sleep(1.0)
                for each in publishers:
                    each.publish(Int32())

        simulation.start(publish, "publisher")
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin()

    simulate(program, until=20.0)
    assert heard == ["a", "b"] * 19
    heard.clear()
    for seed in range(1, 5):
        simulate(program, until=20.0, schedule=PctSchedule(seed))
    assert {*zip(heard[::2], heard[1::2], strict=True)} == {("a", "b"), ("b", "a")}
