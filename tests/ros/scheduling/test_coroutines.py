"""Coroutine callbacks, tasks and futures: what they hold while they wait, and where they go on."""

import asyncio
import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import service
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from sim.ros.scheduling.task import Future, Task
from sim.trace.events import (
    CallbackEnded,
    CallbackFailed,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
)
from tests.support.simulation import Simulation, simulate

Trigger = service("std_srvs", "Trigger")
SetBool = service("std_srvs", "SetBool")


def spin(node: Node, threads: int | None = None) -> Executor:
    executor = SingleThreadedExecutor() if threads is None else MultiThreadedExecutor(threads)
    executor.add_node(node)
    executor.spin()
    return executor


def returned_by_a_function(function: Callable[..., Any]) -> Callable[..., Any]:
    def returns(*arguments: object) -> object:
        return function(*arguments)

    return returns


BOTH = pytest.mark.parametrize("threads", [None, 2], ids=["single", "multi"])


@BOTH
def test_a_suspended_callback_keeps_its_exclusive_group_locked(threads: int | None) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        future: Future[None] = Future()

        async def waits() -> None:
            await future

        def same_group() -> None: ...

        def other_group() -> None: ...

        node.create_timer(1.0, waits).timer_period_ns = 10**12
        node.create_timer(1.1, same_group)
        node.create_timer(1.1, other_group, MutuallyExclusiveCallbackGroup())
        simulation.at(5.0, lambda: future.set_result(None))
        spin(node, threads)

    trace = simulate(program, until=5.2)
    assert trace.times("waits") == [1.0]
    assert trace.ends("waits") == [5.0]
    assert trace.times("same_group") == [5.0]
    assert trace.times("other_group") == [1.1, 2.2, 3.3, 4.4]


@BOTH
def test_a_suspended_callback_is_resumed_as_soon_as_its_future_is_done(threads: int | None) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        future: Future[str] = Future()

        async def waits() -> None:
            assert await future == "done"

        node.create_timer(1.0, waits).timer_period_ns = 10**12
        simulation.at(2.5, lambda: future.set_result("done"))
        spin(node, threads)

    trace = simulate(program, until=20.0)
    kinds = (CallbackStarted, CallbackSuspended, CallbackResumed, CallbackEnded)
    assert [(type(each), each.t / 1e9) for each in trace.events if isinstance(each, kinds)] == [
        (CallbackStarted, 1.0),
        (CallbackSuspended, 1.0),
        (CallbackResumed, 2.5),
        (CallbackEnded, 2.5),
    ]


@BOTH
def test_a_suspended_callback_leaves_its_thread_to_others(threads: int | None) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        async def waits() -> None:
            await Future()

        for _ in range(3):
            node.create_timer(1.0, waits, MutuallyExclusiveCallbackGroup()).timer_period_ns = 10**12
        node.create_timer(2.0, lambda: None, MutuallyExclusiveCallbackGroup())
        spin(node, threads)

    trace = simulate(program, until=7.0)
    assert len(trace.calls("waits")) == 3
    assert trace.times("<lambda>") == [2.0, 4.0, 6.0]


def test_a_reentrant_coroutine_callback_can_be_suspended_many_times_over() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        future: Future[None] = Future()

        async def waits() -> None:
            await future

        node.create_timer(1.0, waits, ReentrantCallbackGroup())
        simulation.at(3.5, lambda: future.set_result(None))
        spin(node)

    trace = simulate(program, until=3.9)
    assert trace.times("waits") == [1.0, 2.0, 3.0]
    assert trace.ends("waits") == [3.5] * 3


@BOTH
def test_awaiting_a_call_inside_a_callback_works_when_the_client_has_another_group(
    threads: int | None,
) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        reply_group = MutuallyExclusiveCallbackGroup()
        client = node.create_client(SetBool, "own", callback_group=reply_group)

        def serve(request: object, response: object) -> object:
            response.message = "served"  # type: ignore[attr-defined]
            return response

        async def asks() -> None:
            reply: Any = await client.call_async(SetBool.Request())
            node.get_logger().info(reply.message)

        node.create_service(SetBool, "own", serve, callback_group=MutuallyExclusiveCallbackGroup())
        node.create_timer(1.0, asks)
        spin(node, threads)

    assert simulate(program, until=2.5).said() == ["served", "served"]


@BOTH
def test_awaiting_a_call_deadlocks_when_the_client_shares_the_exclusive_group(threads: int | None) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        server = simulation.outside_node()
        server.create_service(SetBool, "/s", lambda _, response: response)
        simulation.spin_outside(server)
        client = node.create_client(SetBool, "/s")

        async def asks() -> None:
            await client.call_async(SetBool.Request())

        node.create_timer(1.0, asks)
        spin(node, threads)

    trace = simulate(program, until=9.5)
    assert trace.times("asks") == [1.0]
    assert trace.ends("asks") == []


def test_a_service_handler_may_be_a_coroutine() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        future: Future[str] = Future()

        async def serve(request: object, response: object) -> object:
            response.message = await future  # type: ignore[attr-defined]
            return response

        node.create_service(SetBool, "own", serve)
        simulation.at(3.0, lambda: future.set_result("late"))
        outside = simulation.outside_node()
        simulation.spin_outside(outside)

        def tell(done: Future[Any]) -> None:
            reply: Any = done.result()
            node.get_logger().info(reply.message)

        outside.create_client(SetBool, "/own").call_async(SetBool.Request()).add_done_callback(tell)
        spin(node)

    assert simulate(program, until=4.0).said() == ["late"]


@BOTH
@pytest.mark.parametrize(
    ("wrapped", "runs"),
    [
        (lambda function: function, True),
        (partial, True),
        (returned_by_a_function, False),
    ],
    ids=["function", "partial", "returned"],
)
def test_what_a_callback_returns_is_awaited_if_it_is_a_coroutine_function(
    threads: int | None, wrapped: Callable[[Any], Any], runs: bool
) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        async def says(*_: object) -> None:
            node.get_logger().info("runs")

        node.create_timer(1.0, wrapped(says))
        if runs:
            spin(node, threads)
            return
        with pytest.warns(RuntimeWarning, match="was never awaited"):
            spin(node, threads)

    assert simulate(program, until=2.5).said() == (["runs", "runs"] if runs else [])


def test_a_service_whose_function_returns_a_coroutine_does_not_answer() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        async def serve(_: object, response: object) -> object:
            return response

        node.create_service(SetBool, "own", returned_by_a_function(serve))
        node.create_client(SetBool, "own").call_async(SetBool.Request())
        with pytest.raises(TypeError), pytest.warns(RuntimeWarning, match="was never awaited"):
            spin(node)

    simulate(program, until=2.0)


def test_asyncio_sleep_in_a_callback_finds_no_running_event_loop() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        async def sleeps() -> None:
            await asyncio.sleep(1.0)

        node.create_timer(1.0, sleeps)
        with pytest.raises(RuntimeError, match=r"^no running event loop$"):
            spin(node)

    assert [each.error for each in simulate(program).of(CallbackFailed)] == [
        "RuntimeError: no running event loop"
    ]


def test_an_exception_after_an_await_leaves_spin_and_frees_the_group() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        future: Future[None] = Future()

        async def fails() -> None:
            await future
            raise ValueError("late")

        node.create_timer(1.0, fails).timer_period_ns = 10**12
        node.create_timer(1.5, lambda: None)
        simulation.at(2.0, lambda: future.set_result(None))
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        with pytest.raises(ValueError, match=r"^late$"):
            executor.spin()
        assert simulation.now == 2.0
        executor.spin_once(timeout_sec=0)

    assert simulate(program, distro="lyrical").times("<lambda>") == [2.0]


def test_an_exception_given_to_a_future_is_raised_where_it_is_awaited() -> None:
    caught: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        future: Future[None] = Future()

        async def waits() -> None:
            try:
                await future
            except ValueError as error:
                caught.append(str(error))

        node.create_timer(1.0, waits).timer_period_ns = 10**12
        simulation.at(2.0, lambda: future.set_exception(ValueError("given")))
        spin(node)

    simulate(program, until=3.0)
    assert caught == ["given"]


def test_a_task_gives_its_result_to_who_spins_for_it_and_to_who_awaits_it() -> None:
    def program(simulation: Simulation) -> None:
        executor = SingleThreadedExecutor()

        async def inner(number: int) -> int:
            return number * 2

        async def outer() -> int:
            first = await executor.create_task(inner, 1)
            return (first or 0) + (await inner(10))

        task = executor.create_task(outer())
        executor.spin_until_future_complete(task)
        assert task.result() == 22
        function: Task[int] = executor.create_task(max, 3, 5)
        executor.spin_until_future_complete(function)
        assert function.result() == 5

    simulate(program)


@pytest.mark.parametrize(
    ("distro", "second"), [("jazzy@7.1.5", 1.5), ("jazzy", 1.0)], ids=["at the next wake-up", "at once"]
)
def test_a_coroutine_that_awaits_nothing_in_particular_goes_on_at_once_and_then(
    distro: str, second: float
) -> None:
    went_on: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")

        async def waits() -> None:
            for _ in range(2):
                await asyncio.sleep(0)
                went_on.append(simulation.now)

        node.create_timer(1.0, waits).timer_period_ns = 10**12
        node.create_timer(1.5, lambda: None, MutuallyExclusiveCallbackGroup())
        spin(node)

    assert simulate(program, until=2.0, distro=distro).ends("waits") == [second]
    assert went_on == [1.0, second]


def test_tasks_that_ask_at_each_wake_up_do_not_wake_the_pool_themselves() -> None:
    ended: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        futures: list[Future[None]] = [Future(), Future()]

        async def wait(place: int) -> None:
            await futures[place]
            ended.append(simulation.now)

        def begin() -> None:
            timer.cancel()
            executor.create_task(wait, 0)
            executor.create_task(wait, 1)

        def finish() -> None:
            for each in futures:
                each.set_result(None)

        timer = node.create_timer(0.5, begin, MutuallyExclusiveCallbackGroup())
        node.create_timer(1.0, finish, MutuallyExclusiveCallbackGroup())
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()

    simulate(program, until=1.5, distro="jazzy@7.1.5")
    assert ended == [1.0, 1.0]


@pytest.mark.parametrize("distro", ["jazzy@7.1.5", "kilted"])
def test_what_awaits_is_asked_behind_the_reply_that_a_pool_serves_and_before_it_looks_again(
    distro: str,
) -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2: four runs of four on each.
    said: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")

        async def ask() -> None:
            await client.call_async(Trigger.Request())
            said.append("goes on")

        def begin() -> None:
            timer.cancel()
            simulation.sleep(0.2)
            for _ in range(2):
                executor.create_task(ask())

        def serve(_request: Any, response: Any) -> Any:
            said.append("serves")
            return response

        node.create_service(Trigger, "s", serve)
        client = node.create_client(Trigger, "s")
        timer = node.create_timer(0.3, begin)
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()

    simulate(program, until=1.0, distro=distro)
    assert said == ["serves", "goes on"] * 2


def test_the_result_of_a_pending_future_is_none() -> None:
    future: Future[int] = Future()
    assert future.result() is None
    assert future.exception() is None
    assert not future.done()


def test_a_future_holds_its_result_or_raises_its_exception() -> None:
    future: Future[int] = Future()
    future.set_result(3)
    assert (future.done(), future.result(), future.cancelled()) == (True, 3, False)
    failed: Future[int] = Future()
    failed.set_exception(ValueError("given"))
    with pytest.raises(ValueError, match=r"^given$"):
        failed.result()
    assert isinstance(failed.exception(), ValueError)


def test_a_cancelled_future_is_not_done_and_has_no_result_until_it_is_given_one() -> None:
    future: Future[int] = Future()
    future.cancel()
    assert future.cancelled()
    assert not future.done()
    assert future.result() is None
    future.set_result(3)
    assert (future.done(), future.cancelled(), future.result()) == (True, False, 3)


def test_without_an_executor_done_callbacks_run_at_once_in_the_order_of_adding() -> None:
    heard: list[tuple[str, int | None]] = []
    future: Future[int] = Future()
    future.add_done_callback(lambda done: heard.append(("a", done.result())))
    future.add_done_callback(lambda done: heard.append(("b", done.result())))
    future.set_result(1)
    future.add_done_callback(lambda done: heard.append(("late", done.result())))
    assert heard == [("a", 1), ("b", 1), ("late", 1)]


def test_a_removed_done_callback_is_not_called() -> None:
    heard: list[object] = []
    future: Future[int] = Future()
    future.add_done_callback(heard.append)
    assert future.remove_done_callback(heard.append)
    assert not future.remove_done_callback(heard.append)
    future.set_result(1)
    assert heard == []


def test_a_done_callback_that_fails_does_not_disturb_who_sets_the_result() -> None:
    heard: list[str] = []
    future: Future[int] = Future()

    def fail(_: Future[int]) -> None:
        raise ValueError("listener")

    future.add_done_callback(fail)
    future.add_done_callback(lambda _: heard.append("second"))
    with pytest.warns(RuntimeWarning, match=r"^Unhandled exception in done callback: listener$"):
        future.set_result(1)
    assert heard == ["second"]


def test_with_an_executor_done_callbacks_run_as_its_tasks() -> None:
    heard: list[str] = []

    def program(simulation: Simulation) -> None:
        executor = SingleThreadedExecutor()
        future: Future[int] = Future(executor=executor)
        future.add_done_callback(lambda _: heard.append("called"))
        future.set_result(1)
        assert heard == []
        executor.spin_once(timeout_sec=0)
        assert heard == ["called"]

    simulate(program)


def test_the_done_callback_of_a_reply_runs_in_the_executor_of_the_client() -> None:
    threads: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        server = simulation.outside_node()
        server.create_service(SetBool, "/s", lambda _, response: response)
        simulation.spin_outside(server)
        future = node.create_client(SetBool, "/s").call_async(SetBool.Request())
        future.add_done_callback(lambda _: threads.append(threading.current_thread().name))
        rclpy.spin_until_future_complete(node, future)
        assert threads == []
        for _ in range(3):
            rclpy.spin_once(node, timeout_sec=0)

    simulate(program)
    assert threads == ["MainThread"]


def test_an_exception_that_nobody_fetched_is_told_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    future: Future[int] = Future()
    future.set_exception(ValueError("lost"))
    del future
    assert capsys.readouterr().err == "The following exception was never retrieved: lost\n"
