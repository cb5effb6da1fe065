"""Timers of an EventsExecutor: when they are looked at, and their place in its queue."""

from functools import partial

import pytest

from sim.clock.strategies import RandomWalk
from sim.interfaces import message
from sim.ros.node.node import Node
from sim.ros.parameters.parameter import Parameter
from tests.ros.scheduling.events_executor.bench import Bench, Int32, on_bench

Clock = message("rosgraph_msgs", "Clock")


def test_a_due_timer_is_called_behind_what_came_before_it_was_looked_at() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a", lasts=0.4)
        bench.node.create_timer(1.0, lambda: bench.said.append("tick"))
        bench.register()
        bench.simulation.at(0.9, lambda: a.publish(Int32(data=0)))
        bench.simulation.at(0.95, lambda: a.publish(Int32(data=1)))
        bench.simulation.at(1.2, lambda: a.publish(Int32(data=2)))
        bench.spin_for(2.0)

    # Its look is queued at 1.0, behind a1 and before a2; its call is queued at that look, behind a2.
    assert on_bench(program)[0][:4] == ["a0", "a1", "a2", "tick"]


def test_a_timer_that_waits_for_its_turn_is_called_again_for_each_reset_of_another_one() -> None:
    def program(bench: Bench) -> None:
        node = bench.node
        other = node.create_timer(50.0, lambda: None)
        ticking = node.create_timer(0.5, lambda: bench.said.append(ticking.time_until_next_call()))

        def slow() -> None:
            once.cancel()
            bench.simulation.sleep(0.3)
            other.reset()
            other.reset()

        once = node.create_timer(0.3, slow)
        bench.spin_for(1.9)

    # Measured on Jazzy 7.1.5: 0.40, 0.90 and 1.40 at once, then nothing until 2.0.
    assert on_bench(program)[0] == [400_000_000, 900_000_000, 1_400_000_000]


@pytest.mark.parametrize(
    ("resets", "called"), [(0, ["a", "a", "b", "b"]), (1, ["a", "a", "a", "b", "b"])], ids=["made", "reset"]
)
def test_a_timer_that_is_reset_before_it_is_served_has_timers_looked_at_once_more(
    resets: int, called: list[str]
) -> None:
    def program(bench: Bench) -> None:
        node = bench.node

        def slow() -> None:
            once.cancel()
            made = node.create_timer(50.0, lambda: None)
            for _ in range(resets):
                made.reset()
            bench.simulation.sleep(0.5)

        def tick() -> None:
            bench.said.append("a")
            bench.simulation.sleep(0.0 if bench.said[1:] else 0.5)

        once = node.create_timer(0.1, slow)
        node.create_timer(0.3, tick)
        node.create_timer(0.95, lambda: bench.said.append("b"))
        bench.spin_for(1.15)

    # Measured on Jazzy 7.1.5 and Kilted 9.1.2, a and b in either order at 1.1 s.
    assert sorted(on_bench(program)[0]) == called


def test_ticks_that_were_missed_are_dropped() -> None:
    def program(bench: Bench) -> None:
        def slow() -> None:
            bench.said.append(round(bench.simulation.now, 3))
            if len(bench.said) == 2:
                bench.simulation.sleep(0.35)

        bench.node.create_timer(0.1, slow)
        bench.spin_for(0.75)

    assert on_bench(program)[0] == [0.1, 0.2, 0.55, 0.6, 0.7]


def test_a_timer_that_is_cancelled_while_it_is_queued_is_not_called() -> None:
    def program(bench: Bench) -> None:
        def first() -> None:
            bench.said.append("first")
            second.cancel()

        bench.node.create_timer(1.0, first)
        second = bench.node.create_timer(1.0, lambda: bench.said.append("second"))
        bench.spin_for(1.5)

    assert on_bench(program)[0] == ["first"]


def test_timers_that_fell_due_while_something_ran_come_in_any_order() -> None:
    def program(bench: Bench) -> None:
        bench.node.create_timer(0.5, lambda: bench.simulation.sleep(0.4))
        bench.node.create_timer(0.7, lambda: bench.said.append("first"))
        bench.node.create_timer(0.8, lambda: bench.said.append("second"))
        bench.spin_for(0.95)

    assert on_bench(program)[0] == ["first", "second"]
    orders = {tuple(on_bench(program, schedule=RandomWalk(seed))[0]) for seed in range(8)}
    assert orders == {("first", "second"), ("second", "first")}


@pytest.mark.parametrize("distro", ["jazzy@7.1.5", "kilted@9.1.2"])
def test_timers_of_two_nodes_that_fell_due_while_something_ran_come_in_order(distro: str) -> None:
    # Measured on both: each node has a clock, and each clock its own wait for the next timer.
    def program(bench: Bench) -> None:
        other = Node("m")
        bench.executor.add_node(other)
        bench.hear("busy", lasts=0.9).publish(Int32())
        bench.node.create_timer(0.5, lambda: bench.said.append("first"))
        other.create_timer(0.7, lambda: bench.said.append("second"))
        bench.spin_for(0.95)

    assert on_bench(program, distro=distro)[0] == ["busy0", "first", "second"]


def test_a_timer_on_ros_time_is_called_when_that_comes() -> None:
    def program(bench: Bench) -> None:
        bench.node.set_parameters([Parameter("use_sim_time", value=True)])
        bench.node.create_timer(1.0, lambda: bench.said.append(bench.simulation.now))
        clock = bench.node.create_publisher(Clock, "/clock", 10)
        bench.register()
        for second in range(4):
            told = Clock()
            told.clock.sec = 100 + second
            bench.simulation.at(0.1 * (1 + second), partial(clock.publish, told))
        bench.spin_for(1.0)

    assert on_bench(program)[0] == pytest.approx([0.1, 0.2, 0.3, 0.4])
