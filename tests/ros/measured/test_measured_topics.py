"""The sheet of what real rclpy was measured to do with two 100 Hz topics and a timer that sleeps once."""

from collections.abc import Callable
from itertools import pairwise

import pytest

import sim.ros.rclpy as rclpy
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from tests.ros.measured.nodes import Groups, SubNode, default, shared
from tests.support.simulation import Simulation, Trace, simulate

BEGIN, END = 0.5, 10.5


def run(
    groups: Groups,
    make_executor: Callable[[], Executor] | None,
    until: float = 12.1,
) -> tuple[Trace, dict[str, list[int]]]:
    nodes: list[SubNode] = []

    def program(simulation: Simulation) -> None:
        node = SubNode(simulation, groups)
        nodes.append(node)
        simulation.publisher_at_rate("odom", 0.01, offset=0.003)
        simulation.publisher_at_rate("scan", 0.01, offset=0.006)
        if make_executor is None:
            rclpy.spin(node)
        else:
            executor = make_executor()
            executor.add_node(node)
            executor.spin()

    return simulate(program, until), nodes[0].heard


def during(trace: Trace, name: str) -> int:
    return sum(BEGIN < at < END for at in trace.times(name))


def just_after(trace: Trace) -> list[str]:
    return [each.name for each in trace.calls() if each.at == END]


ALTERNATING = ["odom", "scan"]

ONE_AT_A_TIME = [
    pytest.param(default, None, id="default group, rclpy.spin"),
    pytest.param(default, SingleThreadedExecutor, id="default group, single"),
    pytest.param(shared(), lambda: MultiThreadedExecutor(4), id="shared group, multi(4)"),
]


@pytest.mark.parametrize(("groups", "make_executor"), ONE_AT_A_TIME)
def test_in_one_group_nothing_runs_while_the_timer_sleeps_and_the_queues_keep_ten(
    groups: Groups, make_executor: Callable[[], Executor] | None
) -> None:
    trace, _ = run(groups, make_executor)
    assert (during(trace, "odom"), during(trace, "scan"), during(trace, "timer")) == (0, 0, 0)
    assert (trace.drops("odom"), trace.drops("scan")) == (990, 990)


@pytest.mark.parametrize(("groups", "make_executor"), ONE_AT_A_TIME)
def test_in_one_group_the_late_timer_comes_first_and_then_what_was_kept_by_turns(
    groups: Groups, make_executor: Callable[[], Executor] | None
) -> None:
    trace, heard = run(groups, make_executor)
    assert just_after(trace) == ["timer", *ALTERNATING * 10]
    assert trace.times("timer") == [0.5, 10.5, 11.0, 11.5, 12.0]
    before = 50
    for topic in ("odom", "scan"):
        assert heard[topic][: before + 10] == [*range(before), *range(1040, 1050)]


def test_with_three_groups_and_four_threads_nothing_is_lost_and_only_the_timer_waits_for_itself() -> None:
    trace, heard = run(MutuallyExclusiveCallbackGroup, lambda: MultiThreadedExecutor(4))
    assert (during(trace, "odom"), during(trace, "scan"), during(trace, "timer")) == (1000, 1000, 0)
    assert (trace.drops("odom"), trace.drops("scan")) == (0, 0)
    assert heard["odom"] == list(range(len(heard["odom"])))
    assert just_after(trace) == ["timer"]
    assert trace.times("timer") == [0.5, 10.5, 11.0, 11.5, 12.0]


def test_with_three_groups_and_one_worker_the_two_that_wait_in_the_pool_go_before_the_timer() -> None:
    with pytest.warns(UserWarning, match="single thread"):
        trace, heard = run(MutuallyExclusiveCallbackGroup, lambda: MultiThreadedExecutor(1))
    assert (during(trace, "odom"), during(trace, "scan"), during(trace, "timer")) == (0, 0, 0)
    assert (trace.drops("odom"), trace.drops("scan")) == (990, 990)
    assert just_after(trace) == ["odom", "scan", "timer", *ALTERNATING * 9]
    assert trace.times("timer") == [0.5, 10.5, 11.0, 11.5, 12.0]
    for topic in ("odom", "scan"):
        assert heard[topic][50:60] == list(range(1040, 1050))


def test_callbacks_of_one_shared_group_run_on_the_pools_workers_and_never_on_the_thread_that_spins() -> None:
    trace, _ = run(shared(), lambda: MultiThreadedExecutor(4), until=2.0)
    assert all(each.thread.startswith("ThreadPoolExecutor-0_") for each in trace.calls())


def test_after_the_block_callbacks_of_one_shared_group_change_their_workers() -> None:
    trace, _ = run(shared(), lambda: MultiThreadedExecutor(4))
    workers = [each.thread for each in trace.calls() if each.at == END]
    assert any(one != other for one, other in pairwise(workers))


def test_with_rclpy_spin_every_callback_runs_on_the_main_thread() -> None:
    trace, _ = run(default, None, until=2.0)
    assert {each.thread for each in trace.calls()} == {"MainThread"}
