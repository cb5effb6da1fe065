"""``Client.call`` inside callbacks: who deadlocks, and how many workers it takes not to."""

from collections.abc import Callable

import pytest

from sim.interfaces import service
from sim.ros.exceptions import RCLError
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from sim.trace.events import CallBlocked, CallUnblocked, ServiceReplied
from tests.support.simulation import Simulation, Trace, simulate

SetBool = service("std_srvs", "SetBool")
Groups = Callable[[], CallbackGroup | None]
END = 35.0


def serve_outside(simulation: Simulation, seconds: float = 0.0) -> None:
    """Offer ``/outside`` in another process that works on it for some seconds."""
    node = simulation.outside_node("server")

    def serve(request: object, response: object) -> object:
        simulation.sleep(seconds)
        response.success = True  # type: ignore[attr-defined]
        return response

    node.create_service(SetBool, "/outside", serve)
    simulation.spin_outside(node)


def call_from_timers(make: Callable[[], Executor], callers: int, groups: Groups) -> Trace:
    """``callers`` timers call the outside service once at 1 s; a further timer ticks each 10 s."""

    def program(simulation: Simulation) -> None:
        serve_outside(simulation)
        node = Node("n")
        for _ in range(callers):
            client = node.create_client(SetBool, "/outside", callback_group=groups())
            timer_group = groups()

            def caller(client: object = client) -> None:
                reply = client.call(SetBool.Request(data=True))  # type: ignore[attr-defined]
                assert reply.success

            node.create_timer(1.0, caller, timer_group).timer_period_ns = 10**12

        def tick() -> None: ...

        node.create_timer(10.0, tick, MutuallyExclusiveCallbackGroup())
        executor = make()
        executor.add_node(node)
        executor.spin()

    return simulate(program, until=END)


def one_group(kind: type[CallbackGroup]) -> Groups:
    group = kind()
    return lambda: group


def answered(trace: Trace) -> int:
    """How many calls came back before the end of the run ended them all."""
    return sum(each.t < END * 10**9 for each in trace.of(CallUnblocked))


def test_in_a_single_threaded_executor_a_call_in_a_callback_deadlocks_whatever_the_groups() -> None:
    trace = call_from_timers(SingleThreadedExecutor, 1, MutuallyExclusiveCallbackGroup)
    assert len(trace.of(CallBlocked)) == 1
    assert answered(trace) == 0
    assert trace.times("tick") == []


@pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")
def test_with_one_worker_a_call_in_a_callback_deadlocks_whatever_the_groups() -> None:
    trace = call_from_timers(lambda: MultiThreadedExecutor(1), 1, MutuallyExclusiveCallbackGroup)
    assert answered(trace) == 0
    assert trace.times("tick") == []


def test_caller_and_client_in_one_exclusive_group_deadlock_while_other_groups_go_on() -> None:
    trace = call_from_timers(lambda: MultiThreadedExecutor(2), 1, one_group(MutuallyExclusiveCallbackGroup))
    assert answered(trace) == 0
    assert trace.times("tick") == [10.0, 20.0, 30.0]


def test_the_default_group_deadlocks_as_any_exclusive_group() -> None:
    trace = call_from_timers(lambda: MultiThreadedExecutor(4), 1, lambda: None)
    assert answered(trace) == 0


@pytest.mark.parametrize("callers", [1, 2, 3])
@pytest.mark.parametrize(
    "groups",
    [MutuallyExclusiveCallbackGroup, one_group(ReentrantCallbackGroup)],
    ids=["own groups", "reentrant"],
)
def test_as_many_callers_as_workers_deadlock_and_one_worker_more_frees_them(
    callers: int, groups: Groups
) -> None:
    if callers > 1:
        stuck = call_from_timers(lambda: MultiThreadedExecutor(callers), callers, groups)
        assert len(stuck.of(CallBlocked)) == callers
        assert answered(stuck) == 0
        assert stuck.times("tick") == []
    free = call_from_timers(lambda: MultiThreadedExecutor(callers + 1), callers, groups)
    assert answered(free) == callers
    assert free.times("tick") == [10.0, 20.0, 30.0]


def test_a_call_from_another_thread_than_the_executors_is_answered() -> None:
    def program(simulation: Simulation) -> None:
        serve_outside(simulation, seconds=2.0)
        node = Node("n")
        client = node.create_client(SetBool, "/outside")
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        simulation.start(executor.spin)
        assert client.call(SetBool.Request()).success
        assert simulation.now == 2.0

    trace = simulate(program)
    assert [each.t for each in trace.of(CallUnblocked)] == [2_000_000_000]


def test_a_call_gives_up_after_its_timeout_and_returns_none() -> None:
    def program(simulation: Simulation) -> None:
        serve_outside(simulation, seconds=5.0)
        node = Node("n")
        client = node.create_client(SetBool, "/outside")
        assert client.call(SetBool.Request(), timeout_sec=1.5) is None
        assert simulation.now == 1.5

    simulate(program)


def test_a_call_with_timeout_in_a_callback_ends_the_deadlock() -> None:
    def program(simulation: Simulation) -> None:
        serve_outside(simulation)
        node = Node("n")
        client = node.create_client(SetBool, "/outside")
        answers = []

        def caller() -> None:
            answers.append(client.call(SetBool.Request(), timeout_sec=2.0))
            if len(answers) == 2:
                assert answers == [None, None]

        node.create_timer(1.0, caller)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin()

    trace = simulate(program, until=8.5)
    assert trace.times("caller")[:2] == [1.0, 3.0]


def test_a_server_in_the_same_executor_and_another_group_answers_with_enough_workers() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def serve(request: object, response: object) -> object:
            return response

        node.create_service(SetBool, "own", serve, callback_group=MutuallyExclusiveCallbackGroup())
        client = node.create_client(SetBool, "own", callback_group=MutuallyExclusiveCallbackGroup())
        node.create_timer(1.0, lambda: client.call(SetBool.Request()))
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()

    trace = simulate(program, until=3.5)
    assert [each.t / 1e9 for each in trace.of(ServiceReplied)] == [1.0, 2.0, 3.0]
    assert len(trace.of(CallUnblocked)) == 3


def test_the_blocked_thread_and_callback_are_on_the_trace() -> None:
    trace = call_from_timers(SingleThreadedExecutor, 1, MutuallyExclusiveCallbackGroup)
    (blocked,) = trace.of(CallBlocked)
    assert trace.threads[blocked.thread] == "MainThread"
    assert trace.names[blocked.entity] == "caller"
    assert blocked.service == "/outside"


def test_call_refuses_another_request_type() -> None:
    def program(simulation: Simulation) -> None:
        client = Node("n").create_client(SetBool, "s")
        for request in (SetBool.Response(), "yes", None):
            for call in (client.call, client.call_async):
                with pytest.raises(TypeError):
                    call(request)

    simulate(program)


def test_wait_for_service_needs_no_spinning_and_looks_each_quarter_of_a_second() -> None:
    def program(simulation: Simulation) -> None:
        client = Node("n").create_client(SetBool, "s")
        server = simulation.outside_node()
        simulation.at(0.6, lambda: server.create_service(SetBool, "/s", lambda _, response: response))
        assert not client.service_is_ready()
        assert client.wait_for_service()
        assert simulation.now == 0.75
        assert client.service_is_ready()
        assert client.wait_for_service(timeout_sec=5.0)
        assert simulation.now == 0.75

    simulate(program)


def test_wait_for_service_gives_up_after_its_timeout() -> None:
    def program(simulation: Simulation) -> None:
        client = Node("n").create_client(SetBool, "s")
        assert not client.wait_for_service(timeout_sec=1.0)
        assert simulation.now == 1.0

    simulate(program)


def test_wait_for_service_ends_with_the_context() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        client = node.create_client(SetBool, "s")
        simulation.at(2.1, node.context.shutdown)
        with pytest.raises(RCLError, match="failed to check service availability"):
            client.wait_for_service()
        assert simulation.now == 2.25

    simulate(program)
