"""The sheet of what real rclpy was measured to do with a service that sleeps 5 s beside a 1 s timer."""

from collections.abc import Sequence

import pytest

from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.ros.scheduling.executors import MultiThreadedExecutor
from sim.trace.events import ServiceReplied
from tests.ros.measured.nodes import DummyServer, Groups, SetBool, default, reentrant
from tests.support.simulation import Simulation, Trace, simulate


def run(
    groups: Groups,
    threads: int,
    until: float,
    calls: Sequence[float] = (2.55,),
) -> Trace:
    def program(simulation: Simulation) -> None:
        node = DummyServer(simulation, groups)
        executor = MultiThreadedExecutor(threads)
        executor.add_node(node)
        outside = simulation.outside_node()
        client = outside.create_client(SetBool, "/dummy_server_srv")
        simulation.spin_outside(outside)
        for at in calls:
            simulation.at(at, lambda: client.call_async(SetBool.Request(data=True)))
        executor.spin()

    return simulate(program, until)


def replies(trace: Trace) -> list[float]:
    return [each.t / 1e9 for each in trace.of(ServiceReplied)]


def seconds(*times: float) -> list[float]:
    return list(times)


def test_reentrant_with_two_threads_ticks_every_second_on_the_other_worker() -> None:
    trace = run(reentrant(), 2, until=9.5)
    assert trace.times("timer") == seconds(1, 2, 3, 4, 5, 6, 7, 8, 9)
    (serving,) = trace.calls("serve")
    during = {each.thread for each in trace.calls("timer") if 2.55 < each.at < 7.55}
    assert (serving.at, replies(trace)) == (2.55, [7.55])
    assert {serving.thread, *during} == {"ThreadPoolExecutor-0_0", "ThreadPoolExecutor-0_1"}
    assert serving.thread not in during


def test_reentrant_with_two_threads_and_three_calls_ticks_once_late_when_a_worker_frees() -> None:
    trace = run(reentrant(), 2, until=14.5, calls=[2.55, 2.55, 2.55])
    assert trace.times("serve") == [2.55, 2.55, 7.55]
    assert trace.times("timer") == seconds(1, 2, 7.55, 8, 9, 10, 11, 12, 13, 14)
    assert replies(trace) == [7.55, 7.55, 12.55]


def test_two_exclusive_groups_with_two_threads_tick_every_second_on_the_other_worker() -> None:
    trace = run(MutuallyExclusiveCallbackGroup, 2, until=9.5)
    assert trace.times("timer") == seconds(1, 2, 3, 4, 5, 6, 7, 8, 9)
    (serving,) = trace.calls("serve")
    during = {each.thread for each in trace.calls("timer") if 2.55 < each.at < 7.55}
    assert serving.thread not in during
    assert len(during) == 1


def test_two_exclusive_groups_serve_three_calls_one_after_another_while_ticks_go_on() -> None:
    trace = run(MutuallyExclusiveCallbackGroup, 2, until=18.5, calls=[2.55, 2.55, 2.55])
    assert trace.times("serve") == [2.55, 7.55, 12.55]
    assert trace.times("timer") == [float(second) for second in range(1, 19)]
    assert replies(trace) == [7.55, 12.55, 17.55]


def test_reentrant_with_one_thread_has_one_late_tick_after_the_call_and_the_old_rhythm_then() -> None:
    with pytest.warns(UserWarning, match="single thread"):
        trace = run(reentrant(), 1, until=9.5)
    assert trace.times("timer") == seconds(1, 2, 7.55, 8, 9)
    assert replies(trace) == [7.55]


def test_the_default_group_with_two_threads_replies_first_and_then_has_one_late_tick() -> None:
    trace = run(default, 2, until=9.5)
    assert trace.times("timer") == seconds(1, 2, 7.55, 8, 9)
    reply = next(index for index, each in enumerate(trace.events) if isinstance(each, ServiceReplied))
    before = Trace(trace.events[:reply])
    assert before.times("timer") == seconds(1, 2)
