"""What programs and rclpy's own tests count on of executors, tasks, futures and handles."""

import asyncio
from collections.abc import Callable, Generator
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.ros.exceptions import InvalidHandle, RCLError
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.executors import (
    Executor,
    ExternalShutdownException,
    MultiThreadedExecutor,
    ShutdownException,
    SingleThreadedExecutor,
)
from sim.ros.scheduling.task import Future, Task
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")
Empty = service("std_srvs", "Empty")


def two_threads() -> Executor:
    return MultiThreadedExecutor(2)


every_executor = pytest.mark.parametrize("make", [SingleThreadedExecutor, two_threads])


class Recorder:
    """Takes the place of an executor, and keeps what it is to run."""

    def __init__(self) -> None:
        self.tasks: list[tuple[Any, tuple[Any, ...]]] = []

    def create_task(self, callback: Any, *args: Any) -> None:
        self.tasks.append((callback, args))


@pytest.mark.parametrize("kind", ["timer", "guard condition", "task"])
def test_a_coroutine_goes_on_with_the_next_spin_once(kind: str) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        steps: list[int] = []

        async def coroutine() -> str:
            steps.append(1)
            await asyncio.sleep(0)
            steps.append(2)
            return "result"

        if kind == "timer":
            node.create_timer(0.1, coroutine)
        elif kind == "guard condition":
            node.create_guard_condition(coroutine).trigger()
        else:
            task = executor.create_task(coroutine)
        executor.spin_once(timeout_sec=1.23)
        assert steps == [1]
        executor.spin_once(timeout_sec=0)
        assert steps == [1, 2]
        if kind == "task":
            assert (task.done(), task.result()) == (True, "result")

    simulate(program)


def test_what_a_coroutine_awaits_is_asked_again_in_each_cycle() -> None:
    class Trigger:
        holds_back = True

        def __await__(self) -> Generator[None, None, None]:
            while self.holds_back:
                yield

    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = SingleThreadedExecutor()
        trigger = Trigger()
        steps: list[str] = []

        async def coroutine() -> None:
            steps.append("called")
            await trigger
            steps.append("returned")

        timer = node.create_timer(0.1, coroutine)
        rclpy.spin_once(node, timeout_sec=0.5, executor=executor)
        timer.cancel()
        for _ in range(3):
            rclpy.spin_once(node, timeout_sec=0, executor=executor)
        assert steps == ["called"]
        trigger.holds_back = False
        rclpy.spin_once(node, timeout_sec=0, executor=executor)  # ends the cycle in which it was asked
        assert steps == ["called"]
        rclpy.spin_once(node, timeout_sec=0, executor=executor)
        assert steps == ["called", "returned"]

    simulate(program)


def test_a_task_that_awaits_a_later_task_goes_on_after_it() -> None:
    def program(simulation: Simulation) -> None:
        executor = SingleThreadedExecutor()

        async def first_does() -> str:
            await second
            return "first"

        async def second_does() -> str:
            return "second"

        first = executor.create_task(first_does)
        second = executor.create_task(second_does)
        for _ in range(2):
            executor.spin_once(timeout_sec=0)
        assert (first.done(), second.result()) == (False, "second")
        executor.spin_once(timeout_sec=1)
        assert first.result() == "first"

    simulate(program, distro="kilted@9.1.4")


def test_a_cancelled_task_is_never_run() -> None:
    def program(simulation: Simulation) -> None:
        executor = SingleThreadedExecutor()
        ran: list[int] = []

        async def coroutine() -> None:
            ran.append(1)

        task = executor.create_task(coroutine)
        task.cancel()
        executor.spin_once(timeout_sec=0)
        assert task.cancelled()
        assert task.result() is None
        assert ran == []

    simulate(program)


def test_a_task_tells_whether_it_runs_now() -> None:
    seen: list[bool] = []
    task: Task[None] = Task(lambda: seen.append(task.executing()))
    assert not task.executing()
    task()
    assert seen == [True]
    assert not task.executing()


def test_a_task_passes_arguments_and_runs_once() -> None:
    calls: list[tuple[int, str]] = []
    task: Task[None] = Task(lambda number, *, text: calls.append((number, text)), (1,), {"text": "a"})
    task()
    task()
    assert calls == [(1, "a")]


def test_done_callbacks_go_to_whatever_executor_the_future_has() -> None:
    recorder: Any = Recorder()
    task: Task[None] = Task(lambda: None, executor=recorder)
    task.add_done_callback("first")  # type: ignore[arg-type]
    task()
    cancelled: Future[int] = Future(executor=recorder)
    cancelled.add_done_callback("second")  # type: ignore[arg-type]
    cancelled.cancel()
    done: Future[int] = Future(executor=recorder)
    done.set_result(1)
    done.add_done_callback("third")  # type: ignore[arg-type]
    assert recorder.tasks == [("first", (task,)), ("second", (cancelled,)), ("third", (done,))]


@every_executor
def test_spinning_ends_with_a_cancelled_future(make: Callable[[], Executor]) -> None:
    ended: list[float] = []

    def program(simulation: Simulation) -> None:
        executor = make()
        executor.add_node(Node("n"))
        future: Future[None] = Future()
        simulation.at(1.0, future.cancel)
        executor.spin_until_future_complete(future)
        ended.append(simulation.now)

    simulate(program)
    assert ended == [1.0]


@every_executor
def test_spinning_for_a_future_keeps_to_its_timeout(make: Callable[[], Executor]) -> None:
    ended: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = make()
        executor.add_node(node)
        node.create_timer(0.1, lambda: None)
        done: Future[None] = Future()
        done.set_result(None)
        pending: Future[None] = Future()
        for future, timeout in ((done, None), (pending, 0.0), (pending, 0.25)):
            executor.spin_until_future_complete(future, timeout_sec=timeout)
            ended.append(simulation.now)
        simulation.at(0.4, lambda: pending.set_result(None))
        executor.spin_until_future_complete(pending, timeout_sec=-1.0)
        ended.append(simulation.now)

    simulate(program)
    assert ended == [0.0, 0.0, 0.25, 0.4]


@every_executor
@pytest.mark.parametrize("by", ["callback", "task"])
def test_what_runs_may_shut_its_own_executor_down(make: Callable[[], Executor], by: str) -> None:
    ended: list[Any] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = make()
        executor.add_node(node)
        if by == "callback":
            node.create_timer(0.1, lambda: ended.append(executor.shutdown()))
        else:
            executor.create_task(lambda: ended.append(executor.shutdown()))
        executor.spin()
        ended.append(executor.get_nodes())

    simulate(program)
    assert ended == [True, []]


@pytest.mark.parametrize(
    ("make", "distro", "back_at"),
    [
        (SingleThreadedExecutor, "kilted", 1.2),
        (two_threads, "jazzy@7.1.11", 1.2),
        (two_threads, "kilted", 2.0),
    ],
    ids=["single", "pool", "pool that ends its workers"],
)
def test_shutting_down_waits_for_no_callback_but_in_later_releases_for_a_pools_threads(
    make: Callable[[], Executor], distro: str, back_at: float
) -> None:
    told: list[Any] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = make()
        executor.add_node(node)
        node.create_timer(1.0, lambda: simulation.sleep(1.0))

        def end() -> None:
            simulation.sleep_until(1.2)
            told.append((executor.shutdown(timeout_sec=0.3), simulation.now))

        simulation.start(end)
        executor.spin()
        simulation.sleep_until(4.0)

    assert simulate(program, distro=distro).ends("<lambda>") == [2.0]
    assert told == [(True, back_at)]


def test_an_executor_that_was_shut_down_spins_no_more() -> None:
    ended: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(0.1, lambda: ended.append(-1.0))
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        rows = executor._wait_for_ready_callbacks()
        assert executor.shutdown()
        assert executor.shutdown()
        executor.spin()
        executor.spin_once(timeout_sec=1.0)
        with pytest.raises(ShutdownException):
            next(rows)
        ended.append(simulation.now)

    simulate(program)
    assert ended == [0.0]


def test_spin_once_after_the_context_ended_tells_so() -> None:
    def program(simulation: Simulation) -> None:
        executor = SingleThreadedExecutor()
        executor.add_node(Node("n"))
        rclpy.shutdown()
        executor.spin()
        with pytest.raises(ExternalShutdownException):
            executor.spin_once(timeout_sec=0)
        with pytest.raises(RCLError, match="failed to create timer"):
            executor.spin_once(timeout_sec=0.1)

    simulate(program)


def test_adding_a_node_twice_is_told_and_changes_nothing() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = SingleThreadedExecutor()
        assert executor.add_node(node)
        assert node.executor is executor
        assert not executor.add_node(node)
        assert executor.get_nodes() == [node]
        assert executor.context is node.context

    simulate(program)


def test_a_coroutine_that_cancels_its_timer_and_awaits_a_lost_call_delays_no_other_timer() -> None:
    count: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()
        client = node.create_client(Empty, "nobody", callback_group=group)

        async def once() -> None:
            first.cancel()
            await client.call_async(Empty.Request())

        first = node.create_timer(0.5, once, group)
        node.create_timer(1.5, lambda: count.append(simulation.now), group)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin_until_future_complete(Future(executor=executor), 4)

    simulate(program)
    assert count == [1.5, 3.0]


def test_the_pool_tells_how_many_workers_it_may_have() -> None:
    def program(simulation: Simulation) -> None:
        assert MultiThreadedExecutor(3)._executor._max_workers == 3

    simulate(program)


@pytest.mark.parametrize("kind", ["guard", "timer", "subscription", "publisher", "client", "service", "node"])
def test_what_is_destroyed_while_its_handle_is_used_lives_until_that_ends(kind: str) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        make: dict[str, Callable[[], Any]] = {
            "guard": lambda: node.create_guard_condition(None),
            "timer": lambda: node.create_timer(1.0, lambda: None),
            "subscription": lambda: node.create_subscription(Int32, "t", lambda _: None, 1),
            "publisher": lambda: node.create_publisher(Int32, "t", 1),
            "client": lambda: node.create_client(Empty, "s"),
            "service": lambda: node.create_service(Empty, "s", lambda _, response: response),
            "node": lambda: node,
        }
        entity = make[kind]()
        with entity.handle:
            entity.destroy()
            with entity.handle:
                pass
        with pytest.raises(InvalidHandle), entity.handle:
            pass

    simulate(program)


def test_destroying_a_rate_wakes_who_sleeps_by_it() -> None:
    woken: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        rate = node.create_rate(0.001)
        simulation.at(2.0, lambda: node.destroy_rate(rate))
        rate.sleep()
        woken.append(simulation.now)
        with pytest.raises(RuntimeError, match="has been destroyed"):
            rate.sleep()

    simulate(program)
    assert woken == [2.0]
