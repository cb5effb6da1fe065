"""Exceptions of callbacks: when they come out of spin, and what they leave behind."""

from collections.abc import Callable

import pytest

from sim.clock.strategies import PctSchedule
from sim.interfaces import message
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from sim.ros.scheduling.executors import MultiThreadedExecutor, SingleThreadedExecutor
from sim.trace.events import CallbackFailed, CallbackStarted
from tests.ros.scheduling.test_multi_threaded import spin
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")


def fail() -> None:
    raise ValueError("no scan")


def failing_late(simulation: Simulation) -> Callable[[], None]:
    def fail_late() -> None:
        simulation.sleep(0.1)
        fail()

    return fail_late


def test_in_a_single_threaded_executor_an_exception_leaves_spin_at_once_and_spinning_again_works() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, fail)
        node.create_timer(1.5, lambda: None)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        for at in (1.0, 2.0):
            with pytest.raises(ValueError, match="no scan"):
                executor.spin()
            assert simulation.now == at

    trace = simulate(program)
    assert trace.times("<lambda>") == [1.5]
    assert [each.error for each in trace.of(CallbackFailed)] == ["ValueError: no scan"] * 2
    assert trace.ends("fail") == trace.times("fail")


def test_in_a_multi_threaded_executor_an_exception_comes_out_with_a_later_callback() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: simulation.sleep(4.0), MutuallyExclusiveCallbackGroup())
        node.create_timer(1.2, failing_late(simulation), MutuallyExclusiveCallbackGroup())
        node.create_timer(2.0, lambda: None, MutuallyExclusiveCallbackGroup()).timer_period_ns = 10**12
        with pytest.raises(ValueError, match="no scan"):
            spin(node, 3)
        assert simulation.now == 2.0
        simulation.sleep(5.0)

    trace = simulate(program)
    assert [each.at for each in trace.calls()] == [1.0, 1.2, 2.0]
    assert 5.0 in [end.t / 1e9 for end in trace.events if type(end).__name__ == "CallbackEnded"]


def test_an_exception_comes_out_before_the_callback_begins_with_which_it_comes() -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        guard = node.create_guard_condition(lambda: order.append("begins"), ReentrantCallbackGroup())

        def trigger_and_fail() -> None:
            simulation.sleep(0.1)
            guard.trigger()
            fail()

        for group in (MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()):
            node.create_timer(0.5, lambda: simulation.sleep(0.1), group).timer_period_ns = 10**12
        node.create_timer(1.0, trigger_and_fail).timer_period_ns = 10**12
        node.create_timer(1.05, lambda: order.append("timer of the same group")).timer_period_ns = 10**12
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        with pytest.raises(ValueError, match="no scan"):
            executor.spin()
        order.append("raised")
        executor.spin()

    simulate(program, until=3.0)
    assert order == ["raised", "begins", "timer of the same group"]


@pytest.mark.parametrize("threads", [2, 4])
def test_an_exception_comes_out_after_the_callback_begins_that_a_worker_is_started_for(threads: int) -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        publishers = []

        def hear(name: str) -> None:
            order.append(name)
            if name == "a":
                raise ValueError("no scan")

        for name in "abc":
            group = MutuallyExclusiveCallbackGroup()
            node.create_subscription(Int32, name, lambda _, name=name: hear(name), 10, callback_group=group)
            publishers.append(node.create_publisher(Int32, name, 10))

        def send() -> None:
            timer.cancel()
            for publisher in publishers:
                publisher.publish(Int32())

        timer = node.create_timer(1.0, send, MutuallyExclusiveCallbackGroup())
        executor = MultiThreadedExecutor(threads)
        executor.add_node(node)
        with pytest.raises(ValueError, match="no scan"):
            executor.spin()
        order.append("raised")
        executor.spin()

    simulate(program, until=3.0)
    assert order == ["a", "b", "raised", "c"]


def test_an_exception_of_a_worker_that_has_just_been_started_comes_out_at_once() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(0.5, fail, ReentrantCallbackGroup())
        executor = MultiThreadedExecutor(3)
        executor.add_node(node)
        for at in (0.5, 1.5, 2.0):
            with pytest.raises(ValueError, match="no scan"):
                executor.spin()
            assert simulation.now == at

    simulate(program)


def test_where_threads_race_an_exception_comes_out_as_its_callback_is_handed_over_or_with_a_later_one() -> (
    None
):
    moments = set()

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_guard_condition(fail).trigger()
        node.create_timer(1.0, lambda: None)
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        with pytest.raises(ValueError, match="no scan"):
            executor.spin()
        moments.add(simulation.now)

    for seed in range(2, 42, 2):
        simulate(program, schedule=PctSchedule(seed))
    assert moments == {0.0, 1.0}


def test_until_a_later_callback_comes_a_multi_threaded_spin_goes_on_after_an_exception() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_guard_condition(failing_late(simulation)).trigger()
        spin(node, 2)

    simulate(program, until=10.0)


def test_after_an_exception_a_multi_threaded_executor_can_be_spun_again() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_guard_condition(fail).trigger()
        node.create_timer(1.0, lambda: None)
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        with pytest.raises(ValueError, match="no scan"):
            executor.spin()
        executor.spin()

    assert simulate(program, until=3.5).times("<lambda>") == [1.0, 2.0, 3.0]


class Halted(BaseException):
    """No exception of the usual kind."""


@pytest.mark.parametrize("kind", [SystemExit, KeyboardInterrupt, Halted])
def test_what_is_no_usual_exception_is_lost_on_a_worker_which_runs_the_next_callback(
    kind: type[BaseException],
) -> None:
    def halt() -> None:
        raise kind

    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, halt)
        spin(node, 2)

    trace = simulate(program, until=4.5)
    assert trace.times("halt") == [1.0, 2.0, 3.0, 4.0]
    assert len({each.thread for each in trace.of(CallbackStarted)}) <= 2


def test_after_an_exception_the_group_is_free() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, failing_late(simulation)).timer_period_ns = 10**12
        guard = node.create_guard_condition(lambda: None)
        simulation.at(1.5, guard.trigger)
        with pytest.raises(ValueError, match="no scan"):
            spin(node, 2)
        simulation.sleep(0.1)

    assert simulate(program).times("<lambda>") == [1.5]


@pytest.mark.parametrize("make", [SingleThreadedExecutor, lambda: MultiThreadedExecutor(2)])
def test_what_a_task_raises_comes_out_of_spin_as_a_callbacks_exception_does(
    make: type[SingleThreadedExecutor],
) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        executor = make()
        executor.add_node(node)
        executor.create_task(fail)
        with pytest.raises(ValueError, match="no scan"):
            executor.spin()

    simulate(program)
