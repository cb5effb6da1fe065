"""What is left once something has ended: destroyed entities, removed nodes, executors that were shut down."""

import threading
from collections.abc import Callable

import pytest

from sim.clock import PacedClock
from sim.interfaces import message, service
from sim.probes.probe import SilentProbe
from sim.releases.profile import Profile
from sim.ros.context.context import Context
from sim.ros.entities.subscription import Subscription
from sim.ros.entities.timer import Rate, Timer
from sim.ros.exceptions import InvalidHandle
from sim.ros.middleware.host import Host
from sim.ros.node.node import Node
from sim.ros.scheduling.executors import MultiThreadedExecutor, SingleThreadedExecutor
from tests.support.simulation import Simulation, simulate

Empty = message("std_msgs", "Empty")
SetBool = service("std_srvs", "SetBool")


def ran_one_timer(executor: MultiThreadedExecutor, node: Node) -> None:
    ran = threading.Event()
    timer = node.create_timer(0.001, ran.set)
    executor.add_node(node)
    while not ran.is_set():
        executor.spin_once(timeout_sec=1.0)
    node.destroy_timer(timer)


def test_no_thread_of_a_pool_is_left_after_shutdown() -> None:
    clock = PacedClock()
    host = Host(clock, SilentProbe(clock), profile=Profile.named("kilted"))
    with Context(host=host) as context, Node("n", context=context) as node:
        before = set(threading.enumerate())
        executor = MultiThreadedExecutor(2, context=context)
        ran_one_timer(executor, node)
        assert set(threading.enumerate()) > before
        assert executor.shutdown(timeout_sec=1.0)
        assert set(threading.enumerate()) == before
        assert executor.shutdown()


def test_shutdown_leaves_a_pools_thread_at_work_if_told_not_to_wait_for_it() -> None:
    ended: list[tuple[bool, float]] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        node.create_timer(1.0, lambda: simulation.sleep(1.0))

        def end() -> None:
            simulation.sleep_until(1.2)
            ended.append((executor.shutdown(timeout_sec=0.3, wait_for_threads=False), simulation.now))

        simulation.start(end)
        executor.spin()
        simulation.sleep_until(4.0)

    simulate(program, distro="kilted")
    assert ended == [(True, 1.2)]


def test_a_spin_ends_quietly_when_its_executor_is_shut_down_before_its_context() -> None:
    def program(simulation: Simulation) -> None:
        executor = SingleThreadedExecutor()

        def end() -> None:
            executor.shutdown()
            executor.context.shutdown()

        simulation.at(0.5, end)
        executor.spin()
        assert simulation.now == 0.5

    simulate(program)


def test_a_removed_node_still_names_its_last_executor_and_is_not_served() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        calls: list[float] = []
        node.create_timer(0.1, lambda: calls.append(simulation.now))
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.remove_node(node)
        assert node.executor is executor
        executor.spin_once(timeout_sec=0.5)
        assert calls == []
        assert executor.add_node(node)
        executor.spin_once(timeout_sec=0.5)
        assert calls == [0.5]
        node.executor = None
        assert executor.get_nodes() == []

    simulate(program)


@pytest.mark.parametrize(
    "use",
    [
        Timer.cancel,
        Timer.reset,
        Timer.is_ready,
        Timer.is_canceled,
        Timer.time_until_next_call,
        Timer.time_since_last_call,
    ],
)
def test_a_destroyed_timer_is_an_invalid_handle(use: Callable[[Timer], object]) -> None:
    with Context() as context:
        node = Node("n", context=context)
        timer = node.create_timer(1.0, None)
        with timer.handle:
            node.destroy_timer(timer)
            use(timer)
        with pytest.raises(InvalidHandle):
            use(timer)


def test_a_destroyed_client_or_guard_condition_is_an_invalid_handle() -> None:
    with Context() as context:
        node = Node("n", context=context)
        client = node.create_client(SetBool, "s")
        guard = node.create_guard_condition(None)
        client.destroy()
        guard.destroy()
        for use in (
            client.service_is_ready,
            guard.trigger,
            lambda: client.call_async(SetBool.Request()),
            lambda: client.call(SetBool.Request()),
        ):
            with pytest.raises(InvalidHandle):
                use()


def test_a_rate_sleeps_by_the_timer_it_is_given() -> None:
    woken: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        rate = Rate(node.create_timer(0.25, None), context=node.context)

        def sleep() -> None:
            for _ in range(2):
                rate.sleep()
                woken.append(simulation.now)

        simulation.start(sleep)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        for _ in range(2):
            executor.spin_once()
        simulation.sleep_until(0.6)

    simulate(program)
    assert woken == [0.25, 0.5]


def test_a_future_of_an_executor_has_its_callbacks_run_there() -> None:
    def program(simulation: Simulation) -> None:
        executor = SingleThreadedExecutor()
        future = executor.create_future()
        told: list[object] = []
        future.add_done_callback(lambda done: told.append(done.result()))
        future.set_result(7)
        assert told == []
        executor.spin_once(timeout_sec=0)
        assert told == [7]

    simulate(program)


def test_a_subscription_tells_what_its_callback_takes() -> None:
    with Context() as context:
        node = Node("n", context=context)
        plain = node.create_subscription(Empty, "t", lambda _: None, 1)
        informed = node.create_subscription(Empty, "t", lambda _message, _info: None, 1)
        assert plain._callback_type is Subscription.CallbackType.MessageOnly
        assert informed._callback_type is Subscription.CallbackType.WithMessageInfo
