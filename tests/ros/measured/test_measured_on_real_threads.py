"""What real rclpy was measured to do, on real threads and in tenths of its times: exact in time and order."""

from collections.abc import Callable

import pytest

import sim.ros.rclpy as rclpy
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor
from sim.trace.events import MessageDropped, ServiceReplied
from tests.ros.measured.nodes import DummyServer, Groups, SetBool, SubNode, default, reentrant, shared
from tests.support.real_threads import on_parallel_time, spin
from tests.support.simulation import Simulation, Trace

# Two topics of 100 Hz and a timer whose callback sleeps once

TICK = 0.15
"""The timer's period; the second period ends while the callback sleeps."""
BLOCK = 0.4
END = TICK + BLOCK
NEXT_TICK = 4 * TICK
PUBLISHED_UNTIL = 0.65


def run_topics(
    groups: Groups, make_executor: Callable[[], Executor] | None
) -> tuple[Trace, dict[str, list[int]]]:
    with on_parallel_time() as simulation:
        node = SubNode(simulation, groups, period=TICK, naps=10, nap=BLOCK / 10)
        simulation.publisher_at_rate("odom", 0.01, offset=0.003, until=PUBLISHED_UNTIL)
        simulation.publisher_at_rate("scan", 0.01, offset=0.006, until=PUBLISHED_UNTIL)
        spin_for(simulation, node, 0.7, None if make_executor is None else make_executor())
    return Trace(simulation.events), node.heard


def spin_for(simulation: Simulation, node: Node, seconds: float, executor: Executor | None = None) -> None:
    simulation.at(seconds, rclpy.shutdown)
    spin(node, executor)


def during(trace: Trace, name: str) -> int:
    return sum(TICK < at < END for at in trace.times(name))


def after(trace: Trace) -> list[str]:
    """The callbacks in the order in which they began after the block."""
    return [each.name for each in trace.calls() if each.at >= END]


def check_that_the_oldest_were_dropped_and_ten_kept(trace: Trace, heard: dict[str, list[int]]) -> None:
    for topic, numbers in heard.items():
        assert numbers[:25] == [*range(15), *range(45, 55)]
        assert trace.drops(topic) == 30


def check_the_rhythm(trace: Trace) -> None:
    """One tick before the block, one late tick just after it, and the next where it was due before."""
    assert trace.times("timer") == [TICK, END, NEXT_TICK]
    assert trace.ends("timer")[0] == END


@pytest.mark.parametrize(
    ("groups", "make_executor"),
    [
        pytest.param(default, None, id="default group, rclpy.spin"),
        pytest.param(shared(), lambda: MultiThreadedExecutor(4), id="shared group, multi(4)"),
    ],
)
def test_in_one_group_nothing_runs_during_the_block_and_then_the_timer_and_what_was_kept_by_turns(
    groups: Groups, make_executor: Callable[[], Executor] | None
) -> None:
    trace, heard = run_topics(groups, make_executor)
    assert [during(trace, name) for name in ("odom", "scan", "timer")] == [0, 0, 0]
    assert after(trace)[:21] == ["timer", *["odom", "scan"] * 10]
    check_that_the_oldest_were_dropped_and_ten_kept(trace, heard)
    check_the_rhythm(trace)


def test_with_three_groups_and_four_threads_all_is_heard_and_only_the_timer_waits_for_itself() -> None:
    trace, heard = run_topics(MutuallyExclusiveCallbackGroup, lambda: MultiThreadedExecutor(4))
    assert [during(trace, name) for name in ("odom", "scan", "timer")] == [40, 40, 0]
    assert [len(numbers) for numbers in heard.values()] == [65, 65]
    assert all(numbers == list(range(65)) for numbers in heard.values())
    assert not trace.of(MessageDropped)
    check_the_rhythm(trace)
    (sleeper,) = {each.thread for each in trace.calls("timer") if each.at == TICK}
    others = {each.thread for each in trace.calls() if TICK < each.at < END}
    assert sleeper not in others


def test_with_three_groups_and_one_worker_the_two_that_wait_in_the_pool_go_before_the_timer() -> None:
    with pytest.warns(UserWarning, match="single thread"):
        trace, heard = run_topics(MutuallyExclusiveCallbackGroup, lambda: MultiThreadedExecutor(1))
    assert [during(trace, name) for name in ("odom", "scan", "timer")] == [0, 0, 0]
    assert after(trace)[:21] == ["odom", "scan", "timer", *["odom", "scan"] * 9]
    check_that_the_oldest_were_dropped_and_ten_kept(trace, heard)
    check_the_rhythm(trace)


# A service that sleeps beside a timer

PERIOD = 0.1
CALLED = 0.255
SERVING = 0.3
SERVED = 0.555


def run_service(groups: Groups, threads: int, seconds: float, calls: int = 1) -> Trace:
    with on_parallel_time() as simulation:
        node = DummyServer(simulation, groups, period=PERIOD, naps=3, nap=SERVING / 3)
        outside = simulation.outside_node()
        client = outside.create_client(SetBool, "/dummy_server_srv")
        for _ in range(calls):
            simulation.at(CALLED, lambda: client.call_async(SetBool.Request(data=True)))
        spin_for(simulation, node, seconds, MultiThreadedExecutor(threads))
    return Trace(simulation.events)


def workers_during_the_service(trace: Trace) -> tuple[set[str], set[str]]:
    """On which workers the service was served, and on which the timer ticked meanwhile."""
    (serving,) = trace.calls("serve")
    (end,) = trace.ends("serve")
    return {serving.thread}, {each.thread for each in trace.calls("timer") if serving.at < each.at < end}


@pytest.mark.parametrize(
    "groups",
    [pytest.param(reentrant(), id="reentrant"), pytest.param(MutuallyExclusiveCallbackGroup, id="exclusive")],
)
def test_with_two_threads_the_timer_ticks_on_the_other_worker_while_the_service_sleeps(
    groups: Groups,
) -> None:
    trace = run_service(groups, 2, 0.69)
    assert trace.times("timer") == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    serving, ticking = workers_during_the_service(trace)
    assert serving | ticking == {"ThreadPoolExecutor-0_0", "ThreadPoolExecutor-0_1"}
    assert len(ticking) == 1


def test_three_calls_take_both_workers_of_a_reentrant_group_until_one_is_free_for_a_late_tick() -> None:
    trace = run_service(reentrant(), 2, 0.79, calls=3)
    assert trace.times("serve") == [CALLED, CALLED, SERVED]
    assert trace.times("timer") == [0.1, 0.2, SERVED, 0.6, 0.7]


def test_three_calls_of_an_exclusive_group_take_turns_while_the_ticks_go_on() -> None:
    trace = run_service(MutuallyExclusiveCallbackGroup, 2, 1.19, calls=3)
    starts, ends = trace.times("serve"), trace.ends("serve")
    assert len(ends) == 3
    assert all(start >= end for start, end in zip(starts[1:], ends, strict=False))
    assert trace.times("timer") == [number / 10 for number in range(1, 12)]


@pytest.mark.parametrize(
    ("groups", "threads"),
    [pytest.param(reentrant(), 1, id="reentrant, 1"), pytest.param(default, 2, id="default, 2")],
)
@pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")
def test_with_one_thread_or_one_group_the_reply_comes_first_and_then_one_late_tick(
    groups: Groups, threads: int
) -> None:
    trace = run_service(groups, threads, 0.79)
    assert trace.times("timer") == [0.1, 0.2, SERVED, 0.6, 0.7]
    replied = next(index for index, each in enumerate(trace.events) if isinstance(each, ServiceReplied))
    assert len(Trace(trace.events[:replied]).times("timer")) == 2


# Timers


def test_ticks_missed_while_blocked_are_dropped_and_the_old_rhythm_goes_on() -> None:
    with on_parallel_time() as simulation:
        node = Node("n")
        calls = 0

        def tick() -> None:
            nonlocal calls
            calls += 1
            simulation.sleep(0.35 if calls == 2 else 0.0)

        node.create_timer(0.1, tick)
        spin_for(simulation, node, 0.79)
    assert Trace(simulation.events).times("tick") == [0.1, 0.2, 0.55, 0.6, 0.7]


# Calls inside callbacks


@pytest.mark.parametrize(("workers", "answered"), [(2, False), (3, True)])
def test_two_callers_that_block_at_once_need_a_third_worker(workers: int, answered: bool) -> None:
    replies: list[object] = []
    with on_parallel_time() as simulation:
        spin_for(simulation, node_with_callers(simulation, replies), 0.4, MultiThreadedExecutor(workers))
    first, _ = replies  # who gives up first frees a worker, so the other one may be answered in any case
    assert isinstance(first, SetBool.Response) is answered


def node_with_callers(simulation: Simulation, replies: list[object]) -> Node:
    """A node that serves a service and calls it from two timers at once, every callback in its own group."""
    node = Node("n")
    group = MutuallyExclusiveCallbackGroup()
    node.create_service(SetBool, "s", lambda _, response: response, callback_group=group)

    def add_caller() -> None:
        client = node.create_client(SetBool, "s", callback_group=MutuallyExclusiveCallbackGroup())

        def call() -> None:
            timer.cancel()
            simulation.sleep(0.05)  # until the other one has begun too
            replies.append(client.call(SetBool.Request(), timeout_sec=0.2))

        timer = node.create_timer(0.05, call, callback_group=MutuallyExclusiveCallbackGroup())

    for _ in range(2):
        add_caller()
    return node
