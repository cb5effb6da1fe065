"""Nodes and entities that come and go while an executor spins."""

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message
from sim.ros.exceptions import InvalidNamespaceException, InvalidNodeNameException
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from sim.trace.events import EntityGone, NodeAppeared
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")

BOTH = pytest.mark.parametrize("make", [SingleThreadedExecutor, lambda: MultiThreadedExecutor(2)])


@BOTH
def test_a_node_added_while_an_executor_waits_is_served(make: type[Executor]) -> None:
    def program(simulation: Simulation) -> None:
        executor = make()
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        simulation.at(2.2, lambda: executor.add_node(node))
        executor.spin()

    assert simulate(program, until=4.5).times("<lambda>") == [2.2, 3.0, 4.0]


@BOTH
def test_a_node_removed_while_an_executor_waits_is_served_no_more(make: type[Executor]) -> None:
    def program(simulation: Simulation) -> None:
        executor = make()
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        executor.add_node(node)
        simulation.at(2.2, lambda: executor.remove_node(node))
        executor.spin()

    assert simulate(program, until=4.5).times("<lambda>") == [1.0, 2.0]


@BOTH
def test_entities_made_while_an_executor_waits_are_served(make: type[Executor]) -> None:
    def program(simulation: Simulation) -> None:
        executor = make()
        node = Node("n")
        executor.add_node(node)
        publisher = node.create_publisher(Int32, "t", 10)

        def make_some() -> None:
            node.create_timer(0.5, lambda: None)
            node.create_subscription(Int32, "t", hear, 10)

        def hear(_: object) -> None: ...

        simulation.at(1.0, make_some)
        simulation.at(1.2, lambda: publisher.publish(Int32()))
        executor.spin()

    trace = simulate(program, until=2.1)
    assert trace.times("<lambda>") == [1.5, 2.0]
    assert trace.times("hear") == [1.2]


@BOTH
def test_a_timer_made_by_a_callback_is_served(make: type[Executor]) -> None:
    def program(simulation: Simulation) -> None:
        executor = make()
        node = Node("n")
        executor.add_node(node)

        def begin() -> None:
            first.cancel()
            node.create_timer(0.25, lambda: None)

        first = node.create_timer(1.0, begin)
        executor.spin()

    assert simulate(program, until=1.6).times("<lambda>") == [1.25, 1.5]


def test_adding_a_node_moves_it_from_its_old_executor() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        old, new = SingleThreadedExecutor(), SingleThreadedExecutor()
        assert old.add_node(node)
        assert not old.add_node(node)
        assert new.add_node(node)
        assert (old.get_nodes(), new.get_nodes()) == ([], [node])
        assert node.executor is new
        new.remove_node(node)
        assert new.get_nodes() == []

    simulate(program)


def test_setting_a_nodes_executor_adds_it_there() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = SingleThreadedExecutor()
        node.executor = executor
        assert executor.get_nodes() == [node]
        node.executor = None
        assert executor.get_nodes() == []

    simulate(program)


def test_a_destroyed_node_leaves_its_executor_and_all_its_entities_go() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        node.create_timer(1.0, lambda: None)
        node.create_subscription(Int32, "t", lambda _: None, 10)
        node.create_guard_condition(lambda: None)
        publisher = node.create_publisher(Int32, "t", 10)
        assert publisher.get_subscription_count() == 1
        node.destroy_node()
        node.destroy_node()
        assert executor.get_nodes() == []
        assert not [*node.timers, *node.subscriptions, *node.guards]
        executor.spin_once(timeout_sec=5.0)

    trace = simulate(program)
    assert trace.calls() == []
    assert len(trace.of(EntityGone)) == 3


def test_a_subscription_destroyed_while_its_handler_waits_in_the_pool_is_not_called() -> None:
    heard: list[object] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()
        subscription = node.create_subscription(Int32, "t", heard.append, 10, callback_group=group)
        guards = [node.create_guard_condition(lambda: simulation.sleep(2.0), group) for _ in range(2)]
        publisher = node.create_publisher(Int32, "t", 10)
        for guard in guards:
            guard.trigger()
        simulation.at(0.5, lambda: publisher.publish(Int32()))
        simulation.at(1.0, lambda: node.destroy_subscription(subscription))
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()

    simulate(program, until=5.0)
    assert heard == []


def test_an_entity_may_destroy_itself_in_its_callback() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def last() -> None:
            timer.destroy()

        timer = node.create_timer(1.0, last)
        rclpy.spin(node)

    assert simulate(program, until=5.0).times("last") == [1.0]


def test_destroying_what_belongs_to_another_node_is_refused() -> None:
    def program(simulation: Simulation) -> None:
        mine, other = Node("mine"), Node("other")
        timer = other.create_timer(1.0, lambda: None)
        assert not mine.destroy_timer(timer)
        assert list(other.timers) == [timer]
        assert other.destroy_timer(timer)
        assert not other.destroy_timer(timer)

    simulate(program)


def test_a_guard_condition_calls_back_once_however_often_it_was_triggered() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        guard = node.create_guard_condition(lambda: simulation.sleep(1.0))
        guard.trigger()
        guard.trigger()
        for at in (0.2, 0.4, 5.0):
            simulation.at(at, guard.trigger)
        rclpy.spin(node)

    assert simulate(program, until=10.0).times("<lambda>") == [0.0, 1.0, 5.0]


def test_nodes_are_named_fully_and_bad_names_are_refused() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n", namespace="/arm/left")
        assert (node.get_name(), node.get_namespace()) == ("n", "/arm/left")
        assert node.get_fully_qualified_name() == "/arm/left/n"
        assert node.get_logger().name == "arm.left.n"
        with pytest.raises(InvalidNodeNameException):
            Node("a/b")
        with pytest.raises(InvalidNamespaceException):
            Node("n", namespace="a//b")
        assert rclpy.create_node("made").get_fully_qualified_name() == "/made"

    assert [each.name for each in simulate(program).of(NodeAppeared)] == ["/arm/left/n", "/made"]


def test_what_a_node_has_is_listed_oldest_first() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        timers = [node.create_timer(1.0, lambda: None) for _ in range(3)]
        publishers = [node.create_publisher(Int32, topic, 10) for topic in "ab"]
        assert list(node.timers) == timers
        assert list(node.publishers)[1:] == publishers  # the first one tells of parameters
        node.destroy_timer(timers[1])
        assert list(node.timers) == [timers[0], timers[2]]

    simulate(program)
