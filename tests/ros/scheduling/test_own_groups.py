"""Callback groups that a program writes, on the public base classes."""

import threading
from collections.abc import Callable
from typing import Any

import pytest

from sim.interfaces import message
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from sim.trace.events import CallbackEnded, CallbackStarted
from tests.support.simulation import Simulation, Trace, simulate

Int32 = message("std_msgs", "Int32")


def four_threads() -> Executor:
    return MultiThreadedExecutor(4)


every_executor = pytest.mark.parametrize("make", [SingleThreadedExecutor, four_threads])


class Limited(CallbackGroup):
    """Lets in as many at once as it has places; keeps a lock of its own, as rclpy's own groups do."""

    def __init__(self, places: int) -> None:
        super().__init__()
        self.places = places
        self.inside: list[Any] = []
        self.lock = threading.Lock()

    def can_execute(self, entity: Any) -> bool:
        with self.lock:
            assert self.has_entity(entity)
            return len(self.inside) < self.places

    def beginning_execution(self, entity: Any) -> bool:
        with self.lock:
            if len(self.inside) < self.places:
                self.inside.append(entity)
                return True
            return False

    def ending_execution(self, entity: Any) -> None:
        with self.lock:
            self.inside.remove(entity)


def most_at_once(trace: Trace) -> int:
    """The largest number of callbacks that ran at the same time."""
    running = most = 0
    for event in trace.events:
        running += isinstance(event, CallbackStarted) - isinstance(event, CallbackEnded)
        most = max(most, running)
    return most


@pytest.mark.parametrize("places", [1, 2, 3])
def test_a_group_with_places_lets_in_that_many_and_wakes_the_others_when_one_leaves(places: int) -> None:
    group: list[Limited] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        group.append(Limited(places))

        def work() -> None:
            simulation.sleep(0.5)

        for _ in range(6):
            node.create_guard_condition(work, group[0]).trigger()
        executor = MultiThreadedExecutor(4)
        executor.add_node(node)
        simulation.at(10.0, executor.shutdown)
        executor.spin()

    trace = simulate(program)
    assert most_at_once(trace) == places
    assert max(trace.times("work")) == (6 // places - 1) * 0.5
    assert len(trace.times("work")) == 6
    assert group[0].inside == []


@every_executor
def test_a_group_that_opens_without_a_sign_is_asked_again_at_the_next_wake_up(
    make: Callable[[], Executor],
) -> None:
    class Gate(CallbackGroup):
        is_open = False

        def can_execute(self, entity: Any) -> bool:
            return self.is_open

        def beginning_execution(self, entity: Any) -> bool:
            return self.is_open

        def ending_execution(self, entity: Any) -> None:
            pass

    heard: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        gate = Gate()
        node.create_subscription(Int32, "t", lambda _: heard.append(simulation.now), 10, callback_group=gate)
        node.create_publisher(Int32, "t", 10).publish(Int32())
        node.create_timer(1.0, lambda: None)
        executor = make()
        executor.add_node(node)
        simulation.at(1.5, lambda: setattr(gate, "is_open", True))
        simulation.at(3.5, executor.shutdown)
        executor.spin()

    simulate(program)
    assert heard == [2.0]


@every_executor
def test_a_group_that_extends_the_exclusive_one_may_count_and_refuse(make: Callable[[], Executor]) -> None:
    class Twice(MutuallyExclusiveCallbackGroup):
        left = 2

        def can_execute(self, entity: Any) -> bool:
            return self.left > 0 and super().can_execute(entity)

        def ending_execution(self, entity: Any) -> None:
            self.left -= 1
            super().ending_execution(entity)

    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = Twice()

        def first() -> None:
            simulation.sleep(0.2)

        def second() -> None:
            simulation.sleep(0.2)

        node.create_timer(1.0, first, group)
        node.create_timer(1.0, second, group)
        executor = make()
        executor.add_node(node)
        simulation.at(5.0, executor.shutdown)
        executor.spin()

    trace = simulate(program)
    assert most_at_once(trace) == 1
    assert [(each.name, each.at) for each in trace.calls()] == [("first", 1.0), ("second", 1.2)]


def test_a_group_is_freed_by_a_callback_that_raises() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = Limited(1)

        def fail() -> None:
            raise ValueError("no")

        node.create_timer(1.0, fail, group)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        with pytest.raises(ValueError, match="no"):
            executor.spin()
        assert group.inside == []

    simulate(program)


def test_a_group_that_does_not_say_all_it_must_cannot_be_made() -> None:
    class Half(CallbackGroup):
        def can_execute(self, entity: Any) -> bool:
            return True

    with pytest.raises(TypeError, match="abstract"):
        Half()  # type: ignore[abstract]
