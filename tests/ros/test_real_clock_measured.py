"""What real rclpy was measured to do, on wall time and in tenths of it: exact in order and number.

Times are never early, and late by less than ``LATE``. A run during which the machine was busy with something
else, so that threads were late that only sleep, is not counted.
"""

from collections.abc import Callable, Sequence

import pytest

from sim.ros.callback_groups import MutuallyExclusiveCallbackGroup
from sim.ros.executors import Executor, MultiThreadedExecutor
from sim.ros.node import Node
from sim.trace.events import CallbackStarted, MessageDropped, Published, ServiceReplied
from tests.ros.measured_nodes import DummyServer, Groups, SetBool, SubNode, default, reentrant, shared
from tests.support.simulation import Simulation, Trace
from tests.support.wall_time import in_calm, on_wall_time, spin_for

LATE = 0.075
"""Seconds."""

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
    def run() -> tuple[Trace, dict[str, list[int]]]:
        with on_wall_time() as simulation:
            node = SubNode(simulation, groups, period=TICK, naps=10, nap=BLOCK / 10)
            simulation.publisher_at_rate("odom", 0.01, offset=0.003, until=PUBLISHED_UNTIL)
            simulation.publisher_at_rate("scan", 0.01, offset=0.006, until=PUBLISHED_UNTIL)
            spin_for(node, 0.7, None if make_executor is None else make_executor())
        return Trace(simulation.events), node.heard

    return in_calm(run, lambda result: nothing_waited_when_the_block_began(result[0]))


def nothing_waited_when_the_block_began(trace: Trace) -> bool:
    """Whether no message came in one snapshot with the first tick, to be served right after it."""
    begin, _ = block_of(trace)
    published = sum(each.t / 1e9 < begin for each in trace.of(Published) if each.topic in {"/odom", "/scan"})
    return published == sum(each.at < begin for each in trace.calls())


def block_of(trace: Trace) -> tuple[float, float]:
    """When the callback that sleeps began and ended."""
    return trace.times("timer")[0], trace.ends("timer")[0]


def during(trace: Trace, name: str) -> int:
    begin, end = block_of(trace)
    return sum(begin < at < end for at in trace.times(name))


def after(trace: Trace) -> list[str]:
    """The callbacks in the order in which they began after the block."""
    _, end = block_of(trace)
    return [each.name for each in trace.calls() if each.at >= end]


def published_before_the_first_take_after_the_block(trace: Trace, topic: str) -> int:
    _, end = block_of(trace)
    entity = trace.entity(topic)
    published = 0
    for event in trace.events:
        if isinstance(event, Published) and event.topic == f"/{topic}":
            published += 1
        elif isinstance(event, CallbackStarted) and event.entity == entity and event.t / 1e9 >= end:
            break
    return published


def check_that_the_oldest_were_dropped_and_ten_kept(trace: Trace, heard: dict[str, list[int]]) -> None:
    begin, _ = block_of(trace)
    for topic, numbers in heard.items():
        before = sum(at < begin for at in trace.times(topic))
        assert numbers[:before] == list(range(before))
        published = published_before_the_first_take_after_the_block(trace, topic)
        assert numbers[before : before + 10] == list(range(published - 10, published))
        assert published - 10 - before >= 20  # some 40 came while 10 had room
        assert trace.drops(topic) == max(numbers) + 1 - len(numbers)


def check_the_rhythm(trace: Trace) -> None:
    """One tick before the block, one late tick just after it, and the next where it was due before."""
    first, late, following = trace.times("timer")[:3]
    _, end = block_of(trace)
    assert TICK <= first < TICK + LATE
    assert END <= end <= late < END + LATE
    assert NEXT_TICK <= following < NEXT_TICK + LATE


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
    first, *rest = after(trace)
    assert first == "timer"
    assert [name for name in rest if name != "timer"][:20] == ["odom", "scan"] * 10
    check_that_the_oldest_were_dropped_and_ten_kept(trace, heard)
    check_the_rhythm(trace)


def test_with_three_groups_and_four_threads_all_is_heard_and_only_the_timer_waits_for_itself() -> None:
    trace, heard = run_topics(MutuallyExclusiveCallbackGroup, lambda: MultiThreadedExecutor(4))
    begin, end = block_of(trace)
    for topic, numbers in heard.items():
        assert numbers == list(range(len(numbers)))
        came = [each.t / 1e9 for each in trace.of(Published) if each.topic == f"/{topic}"]
        surely = sum(begin < at < end - LATE for at in came)
        assert 20 <= surely <= during(trace, topic) <= sum(begin - LATE < at < end for at in came)
        assert {begin < at < end for at in trace.times(topic)} == {True, False}
    assert during(trace, "timer") == 0
    assert not trace.of(MessageDropped)
    check_the_rhythm(trace)
    (sleeper,) = {each.thread for each in trace.calls("timer") if each.at == begin}
    others = {each.thread for each in trace.calls() if begin < each.at < end}
    assert sleeper not in others


def test_with_three_groups_and_one_worker_the_two_that_wait_in_the_pool_go_before_the_timer() -> None:
    with pytest.warns(UserWarning, match="single thread"):
        trace, heard = run_topics(MutuallyExclusiveCallbackGroup, lambda: MultiThreadedExecutor(1))
    assert [during(trace, name) for name in ("odom", "scan", "timer")] == [0, 0, 0]
    *waiting, third = after(trace)[:3]
    assert sorted(waiting) == ["odom", "scan"]  # whichever was published first
    assert third == "timer"
    assert [name for name in after(trace)[3:] if name != "timer"][:18] == ["odom", "scan"] * 9
    check_that_the_oldest_were_dropped_and_ten_kept(trace, heard)
    check_the_rhythm(trace)


# A service that sleeps beside a timer

PERIOD = 0.1
CALLED = 0.255
SERVING = 0.3
SERVED = CALLED + SERVING


def run_service(groups: Groups, threads: int, seconds: float, calls: int = 1) -> Trace:
    def run() -> Trace:
        with on_wall_time() as simulation:
            node = DummyServer(simulation, groups, period=PERIOD, naps=3, nap=SERVING / 3)
            outside = simulation.outside_node()
            client = outside.create_client(SetBool, "/dummy_server_srv")
            for _ in range(calls):
                simulation.at(CALLED, lambda: client.call_async(SetBool.Request(data=True)))
            spin_for(node, seconds, MultiThreadedExecutor(threads))
        return Trace(simulation.events)

    return in_calm(run)


def check_times(times: Sequence[float], expected: Sequence[float]) -> None:
    """Whether these came, each in its time and none between; more may follow until spinning ends."""
    assert len(times) >= len(expected), times
    for at, due in zip(times, expected, strict=False):
        assert due <= at < due + LATE, times


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
    check_times(trace.times("timer"), [0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    serving, ticking = workers_during_the_service(trace)
    assert serving | ticking == {"ThreadPoolExecutor-0_0", "ThreadPoolExecutor-0_1"}
    assert len(ticking) == 1


def test_three_calls_take_both_workers_of_a_reentrant_group_until_one_is_free_for_a_late_tick() -> None:
    trace = run_service(reentrant(), 2, 0.8, calls=3)
    check_times(trace.times("serve"), [CALLED, CALLED, SERVED])
    check_times(trace.times("timer"), [0.1, 0.2, SERVED, 0.6, 0.7])


def test_three_calls_of_an_exclusive_group_take_turns_while_the_ticks_go_on() -> None:
    trace = run_service(MutuallyExclusiveCallbackGroup, 2, 1.19, calls=3)
    starts, ends = trace.times("serve"), trace.ends("serve")
    assert len(ends) == 3
    assert all(start >= end for start, end in zip(starts[1:], ends, strict=False))
    check_times(trace.times("timer"), [PERIOD * number for number in range(1, 12)])


@pytest.mark.parametrize(
    ("groups", "threads"),
    [pytest.param(reentrant(), 1, id="reentrant, 1"), pytest.param(default, 2, id="default, 2")],
)
@pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")
def test_with_one_thread_or_one_group_the_reply_comes_first_and_then_one_late_tick(
    groups: Groups, threads: int
) -> None:
    trace = run_service(groups, threads, 0.79)
    check_times(trace.times("timer"), [0.1, 0.2, SERVED, 0.6, 0.7])
    replied = next(index for index, each in enumerate(trace.events) if isinstance(each, ServiceReplied))
    assert len(Trace(trace.events[:replied]).times("timer")) == 2


# Timers


def test_ticks_missed_while_blocked_are_dropped_and_the_old_rhythm_goes_on() -> None:
    def run() -> list[float]:
        with on_wall_time() as simulation:
            node = Node("n")
            calls = 0

            def tick() -> None:
                nonlocal calls
                calls += 1
                simulation.sleep(0.35 if calls == 2 else 0.0)

            node.create_timer(0.1, tick)
            spin_for(node, 0.79)
        return Trace(simulation.events).times("tick")

    check_times(in_calm(run), [0.1, 0.2, 0.55, 0.6, 0.7])


# Calls inside callbacks


@pytest.mark.parametrize(("workers", "answered"), [(2, False), (3, True)])
def test_two_callers_that_block_at_once_need_a_third_worker(workers: int, answered: bool) -> None:
    def run() -> list[object]:
        replies: list[object] = []
        with on_wall_time() as simulation:
            spin_for(node_with_callers(simulation, replies), 0.4, MultiThreadedExecutor(workers))
        return replies

    # Who gives up first frees a worker, so the other one may be answered in any case.
    first, _ = in_calm(run)
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
