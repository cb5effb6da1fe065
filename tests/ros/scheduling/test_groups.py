"""Callback groups: who is let in while who is inside, the program's own kinds, and groups that are shared."""

import gc

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.executors import MultiThreadedExecutor, SingleThreadedExecutor
from sim.trace.events import GroupAppeared, GroupKind, Reason, WaitEnded, WaitStarted
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")


def test_an_exclusive_group_lets_one_in_at_a_time() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = MutuallyExclusiveCallbackGroup()
        first = node.create_timer(1.0, lambda: None, group)
        second = node.create_timer(1.0, lambda: None, group)
        assert group.can_execute(first)
        assert group.beginning_execution(first)
        assert not group.can_execute(second)
        assert not group.can_execute(first)
        assert not group.beginning_execution(second)
        group.ending_execution(first)
        assert group.beginning_execution(second)

    simulate(program)


def test_a_reentrant_group_lets_everything_in_the_same_callback_too() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()
        timer = node.create_timer(1.0, lambda: None, group)
        for _ in range(3):
            assert group.can_execute(timer)
            assert group.beginning_execution(timer)

    simulate(program)


def test_a_group_knows_its_members_and_holds_them_weakly() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()
        mine = node.create_timer(1.0, lambda: None, group)
        other = node.create_timer(1.0, lambda: None)
        assert group.has_entity(mine)
        assert not group.has_entity(other)
        (reference,) = group.entities
        node.destroy_timer(mine)
        node._agenda._timer_queue.clear()
        del mine
        gc.collect()
        assert reference() is None

    simulate(program)


def test_the_default_group_is_one_exclusive_group_for_all_that_name_none() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        assert type(node.default_callback_group) is MutuallyExclusiveCallbackGroup
        entities: list[Entity] = [
            node.create_timer(1.0, lambda: None),
            node.create_subscription(Int32, "t", lambda _: None, 10),
            node.create_guard_condition(lambda: None),
        ]
        assert {each.callback_group for each in entities} == {node.default_callback_group}
        assert Node("m").default_callback_group is not node.default_callback_group

    trace = simulate(program)
    (group,) = trace.of(GroupAppeared)
    assert (group.kind, group.class_name) == (GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup")


class AtMostTwo(CallbackGroup):
    """A program's own kind: two at a time."""

    def __init__(self) -> None:
        super().__init__()
        self.inside = 0

    def can_execute(self, entity: Entity) -> bool:
        return self.inside < 2

    def beginning_execution(self, entity: Entity) -> bool:
        if self.inside >= 2:
            return False
        self.inside += 1
        return True

    def ending_execution(self, entity: Entity) -> None:
        self.inside -= 1


def test_a_programs_own_kind_of_group_decides() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = AtMostTwo()
        for _ in range(3):
            node.create_timer(1.0, lambda: simulation.sleep(2.0), group).timer_period_ns = 10**12
        executor = MultiThreadedExecutor(4)
        executor.add_node(node)
        executor.spin()

    trace = simulate(program, until=10.0)
    assert trace.times("<lambda>") == [1.0, 1.0, 3.0]
    (group,) = trace.of(GroupAppeared)
    assert (group.kind, group.class_name) == (GroupKind.CUSTOM, "AtMostTwo")


class Wary(MutuallyExclusiveCallbackGroup):
    """Says that an entity may execute and refuses it all the same the first time."""

    refused = 0

    def beginning_execution(self, entity: Entity) -> bool:
        if self.refused == 0:
            self.refused += 1
            return False
        return super().beginning_execution(entity)


@pytest.mark.parametrize("make", [SingleThreadedExecutor, lambda: MultiThreadedExecutor(2)])
def test_a_refused_handler_takes_nothing_and_its_entity_is_yielded_again(
    make: type[SingleThreadedExecutor],
) -> None:
    heard: list[int] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_subscription(Int32, "t", lambda m: heard.append(m.data), 10, callback_group=Wary())
        node.create_publisher(Int32, "t", 10).publish(Int32(data=7))
        executor = make()
        executor.add_node(node)
        executor.spin()

    simulate(program, until=1.0)
    assert heard == [7]


def test_a_group_shared_by_two_executors_excludes_across_them_and_its_release_wakes_only_one() -> None:
    def program(simulation: Simulation) -> None:
        group = MutuallyExclusiveCallbackGroup()
        first, second = Node("first"), Node("second")
        publisher = first.create_publisher(Int32, "t", 10)
        first.create_timer(1.0, lambda: simulation.sleep(1.0), group).timer_period_ns = 10**12
        second.create_subscription(Int32, "t", lambda _: None, 10, callback_group=group)
        second.create_timer(4.0, lambda: None).timer_period_ns = 10**12
        simulation.at(1.5, lambda: publisher.publish(Int32()))
        for node in (first, second):
            executor = SingleThreadedExecutor()
            executor.add_node(node)
            simulation.start(executor.spin, node.get_name())
        simulation.sleep(10.0)
        rclpy.shutdown()

    trace = simulate(program)
    assert [(each.at, each.thread) for each in trace.calls()] == [
        (1.0, "first"),
        (4.0, "second"),
        (4.0, "second"),
    ]
    assert [(each.t / 1e9, each.reason) for each in trace.of(WaitStarted)] == [(1.5, Reason.GROUP_HELD)]
    assert [each.t / 1e9 for each in trace.of(WaitEnded)] == [2.0]
