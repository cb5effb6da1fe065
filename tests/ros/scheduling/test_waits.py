"""What the trace says of callbacks that are ready and do not run: since when, why, and because of whom."""

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from sim.ros.scheduling.executors import MultiThreadedExecutor, SingleThreadedExecutor
from sim.trace.events import Reason, WaitEnded, WaitStarted
from sim.trace.model import Window
from tests.support.builder import ns
from tests.support.real_threads import on_parallel_time, spin
from tests.support.simulation import Simulation, Trace, simulate

Int32 = message("std_msgs", "Int32")


def waits(trace: Trace) -> list[tuple[float, float, str, Reason, str, bool]]:
    """Each reason given: when, since when, who waits, why, for whom, and whether no worker was free."""
    names = {**trace.names, 0: ""}
    return [
        (
            each.t / 1e9,
            each.since / 1e9,
            names[each.entity],
            each.reason,
            names[each.holder],
            each.workers_busy,
        )
        for each in trace.of(WaitStarted)
    ]


def ended(trace: Trace) -> list[tuple[float, str]]:
    return [(each.t / 1e9, trace.names[each.entity]) for each in trace.of(WaitEnded)]


def run(groups: tuple[object, object], threads: int | None) -> Trace:
    """``slow`` works from 1 to 4 s; ``quick`` is due at 2 s."""

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def slow() -> None:
            simulation.sleep(3.0)

        def quick() -> None: ...

        node.create_timer(1.0, slow, groups[0]).timer_period_ns = 10**12  # type: ignore[arg-type]
        node.create_timer(2.0, quick, groups[1]).timer_period_ns = 10**12  # type: ignore[arg-type]
        executor = SingleThreadedExecutor() if threads is None else MultiThreadedExecutor(threads)
        executor.add_node(node)
        executor.spin()

    return simulate(program, until=10.0)


def test_a_callback_of_a_held_group_waits_for_who_holds_it_though_a_worker_is_free() -> None:
    group = MutuallyExclusiveCallbackGroup()
    trace = run((group, group), threads=2)
    assert waits(trace) == [(2.0, 2.0, "quick", Reason.GROUP_HELD, "slow", False)]
    assert ended(trace) == [(4.0, "quick")]


def test_where_the_group_is_held_and_no_worker_free_both_are_said() -> None:
    group = MutuallyExclusiveCallbackGroup()
    trace = run((group, group), threads=None)
    assert waits(trace) == [(2.0, 2.0, "quick", Reason.GROUP_HELD, "slow", True)]


def test_a_callback_whose_group_is_free_waits_for_a_worker() -> None:
    trace = run((MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()), threads=None)
    assert waits(trace) == [(2.0, 2.0, "quick", Reason.NO_FREE_WORKER, "slow", True)]
    assert ended(trace) == [(4.0, "quick")]


@pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")
def test_a_callback_that_waits_in_the_pool_waits_for_a_worker() -> None:
    trace = run((ReentrantCallbackGroup(), ReentrantCallbackGroup()), threads=1)
    assert waits(trace) == [(2.0, 2.0, "quick", Reason.NO_FREE_WORKER, "slow", True)]


def test_a_callback_that_can_run_waits_for_nothing() -> None:
    trace = run((MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()), threads=2)
    assert waits(trace) == []
    assert trace.times("quick") == [2.0]


def test_where_nobody_spins_that_is_the_reason() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        simulation.sleep(3.0)
        rclpy.spin_once(node)
        simulation.sleep(3.0)

    trace = simulate(program)
    assert waits(trace) == [
        (1.0, 1.0, "<lambda>", Reason.NOBODY_SPINS, "", False),
        (4.0, 4.0, "<lambda>", Reason.NOBODY_SPINS, "", False),
    ]
    assert ended(trace) == [(3.0, "<lambda>")]


def test_a_reason_that_changes_is_told_anew_and_keeps_since_when() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = MutuallyExclusiveCallbackGroup()

        def first() -> None:
            simulation.sleep(2.0)

        def second() -> None:
            simulation.sleep(2.0)

        def third() -> None: ...

        for callback in (first, second, third):
            node.create_timer(1.0, callback, group).timer_period_ns = 10**12
        rclpy.spin(node)

    trace = simulate(program, until=10.0)
    assert waits(trace) == [
        (1.0, 1.0, "second", Reason.GROUP_HELD, "first", True),
        (1.0, 1.0, "third", Reason.GROUP_HELD, "first", True),
        (3.0, 1.0, "third", Reason.GROUP_HELD, "second", True),
    ]
    assert ended(trace) == [(3.0, "second"), (5.0, "third")]


@pytest.mark.parametrize("shares_group", [True, False])
def test_on_the_real_clock_what_keeps_a_callback_is_dated_though_nobody_looks_until_it_is_over(
    shares_group: bool,
) -> None:
    """``third`` is due at 1.5 s; until 5 s the others keep it: in its group, or on its thread."""
    with on_parallel_time() as simulation:
        node = Node("n")

        def first() -> None:
            simulation.sleep(2.0)

        def second() -> None:
            simulation.sleep(2.0)

        def third() -> None:
            rclpy.shutdown()

        for callback, due in ((first, 1.0), (second, 1.0), (third, 1.5)):
            group = None if shares_group else MutuallyExclusiveCallbackGroup()
            node.create_timer(due, callback, group).timer_period_ns = 10**12
        spin(node, MultiThreadedExecutor(2) if shares_group else SingleThreadedExecutor())
        trace = Trace(simulation.events)
    third_wait = trace.timeline().waits_of(trace.entity("third"), Window(0, 10**10))
    assert [(each.start, each.end, trace.names[each.holder]) for each in third_wait] == [
        (ns(1.5), ns(3.0), "first"),
        (ns(3.0), ns(5.0), "second"),
    ]


def test_a_full_queue_waits_for_its_own_callback() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def hear(_: object) -> None:
            simulation.sleep(1.0)

        node.create_subscription(Int32, "t", hear, 10)
        publisher = node.create_publisher(Int32, "t", 10)
        for _ in range(2):
            publisher.publish(Int32())
        rclpy.spin(node)

    assert waits(simulate(program, until=5.0)) == [(0.0, 0.0, "hear", Reason.GROUP_HELD, "hear", True)]


def test_a_wait_ends_when_the_timer_is_cancelled_or_the_entity_destroyed() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = MutuallyExclusiveCallbackGroup()
        node.create_timer(1.0, lambda: simulation.sleep(9.0), group).timer_period_ns = 10**12

        def cancelled() -> None: ...

        def destroyed() -> None: ...

        timers = [node.create_timer(2.0, callback, group) for callback in (cancelled, destroyed)]
        simulation.at(3.0, timers[0].cancel)
        simulation.at(4.0, timers[1].destroy)
        rclpy.spin(node)

    trace = simulate(program, until=8.0)
    assert ended(trace) == [(3.0, "cancelled"), (4.0, "destroyed")]


def test_a_suspended_coroutine_is_who_holds_its_group() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        async def waits_long() -> None:
            await rclpy.Future()

        def other() -> None: ...

        node.create_timer(1.0, waits_long).timer_period_ns = 10**12
        node.create_timer(2.0, other)
        rclpy.spin(node)

    assert waits(simulate(program, until=3.0)) == [
        (2.0, 2.0, "other", Reason.GROUP_HELD, "waits_long", False)
    ]


def test_waits_of_several_nodes_are_told_in_the_order_of_the_nodes() -> None:
    def program(simulation: Simulation) -> None:
        nodes = [Node(f"n{number}") for number in range(8)]
        for number, node in enumerate(nodes):

            def callback() -> None: ...

            callback.__name__ = f"callback_{number}"
            node.create_timer(1.0, callback)
        simulation.sleep(2.0)

    told = [each[2] for each in waits(simulate(program))]
    assert told == [f"callback_{number}" for number in range(8)]


def test_a_callback_that_waits_in_the_pool_between_two_spin_once_waits_for_a_worker() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()
        slow = [node.create_guard_condition(lambda: simulation.sleep(3.0), group) for _ in range(2)]

        def quick() -> None: ...

        guard = node.create_guard_condition(quick, group)
        for each in (*slow, guard):
            each.trigger()
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        for _ in range(3):
            executor.spin_once(timeout_sec=0)
        simulation.sleep(5.0)

    trace = simulate(program)
    assert waits(trace) == [(0.0, 0.0, "quick", Reason.NO_FREE_WORKER, "<lambda>", True)]
    assert trace.times("quick") == [3.0]
