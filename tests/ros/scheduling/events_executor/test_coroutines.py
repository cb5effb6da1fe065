"""Coroutines on an EventsExecutor, in each release, and calls that wait inside callbacks."""

import gc
from contextlib import nullcontext
from typing import Any

import pytest

from sim.interfaces import service
from sim.ros.scheduling.task import Future
from sim.trace.events import CallbackResumed, CallbackSuspended
from tests.ros.scheduling.events_executor.bench import Bench, Int32, on_bench

SetBool = service("std_srvs", "SetBool")


def test_a_suspended_callback_keeps_nobody_out_of_its_group() -> None:
    def program(bench: Bench) -> None:
        bench.node.create_service(SetBool, "s", lambda _, response: response)
        client = bench.node.create_client(SetBool, "s")

        async def ask() -> None:
            timer.cancel()
            bench.said.append("asks")
            bench.said.append(await client.call_async(SetBool.Request()))

        timer = bench.node.create_timer(1.0, ask)
        bench.spin_for(1.5)

    said, trace = on_bench(program)
    assert said == ["asks", SetBool.Response()]
    assert len(trace.of(CallbackSuspended)) == 2  # it begins as a task, and then awaits the reply
    assert len(trace.of(CallbackResumed)) == 2


def test_in_earlier_releases_a_subscriptions_coroutine_is_never_run() -> None:
    def program(bench: Bench) -> None:
        async def heard(_: Any) -> None:
            bench.said.append("never")

        bench.node.create_subscription(Int32, "a", heard, 10)
        bench.register()
        bench.node.create_publisher(Int32, "a", 10).publish(Int32())
        with pytest.warns(RuntimeWarning, match="was never awaited"):
            bench.spin_once()

    assert on_bench(program, distro="jazzy@7.1.10")[0] == []


def spin_in_vain(bench: Bench) -> None:
    with pytest.raises(TypeError):
        bench.spin_once()
    gc.collect()  # the exception's traceback holds the coroutine


def test_in_earlier_releases_a_services_coroutine_is_no_response() -> None:
    def program(bench: Bench) -> None:
        async def serve(_: Any, response: Any) -> Any:
            return response

        bench.node.create_service(SetBool, "s", serve)
        bench.register()
        reply = bench.node.create_client(SetBool, "s").call_async(SetBool.Request())
        with pytest.warns(RuntimeWarning, match="was never awaited"):
            spin_in_vain(bench)
        bench.said.append(reply.done())

    said, trace = on_bench(program, distro="jazzy@7.1.10")
    assert said == [False]
    assert trace.said() == []  # what is raised after the callback is not logged


def test_a_call_inside_a_callback_finds_nobody_to_answer() -> None:
    def program(bench: Bench) -> None:
        def serve(_: Any, response: Any) -> Any:
            bench.said.append("serves")
            return response

        bench.node.create_service(SetBool, "s", serve)
        client = bench.node.create_client(SetBool, "s")

        def ask() -> None:
            timer.cancel()
            bench.said.append(client.call(SetBool.Request(), timeout_sec=0.5))

        timer = bench.node.create_timer(1.0, ask)
        bench.spin_for(2.0)

    assert on_bench(program)[0] == [None, "serves"]


def test_the_response_of_a_services_coroutine_is_an_event_behind_others() -> None:
    # Measured on Kilted 9.1.2: a done-callback of the task sends it, which is a task itself.
    def program(bench: Bench) -> None:
        async def serve(_: Any, response: Any) -> Any:
            first.publish(Int32())
            return response

        def hear(topic: str, then: Any) -> Any:
            def heard(_: Any) -> None:
                bench.said.append(topic)
                if then is not None:
                    then.publish(Int32())

            bench.node.create_subscription(Int32, topic, heard, 10)
            return bench.node.create_publisher(Int32, topic, 10)

        first = hear("first", hear("second", hear("third", None)))
        bench.node.create_service(SetBool, "s", serve)
        client = bench.node.create_client(SetBool, "s")
        bench.register()
        client.call_async(SetBool.Request()).add_done_callback(lambda _: bench.said.append("got"))
        bench.spin_for(0.5)

    assert on_bench(program, distro="kilted")[0] == ["first", "second", "third", "got"]


@pytest.mark.parametrize("raises", [False, True])
@pytest.mark.parametrize("distro", ["jazzy@7.1.5", "kilted"])
def test_what_awaits_is_asked_behind_what_the_next_callback_sends(distro: str, raises: bool) -> None:
    # Measured on both.
    def program(bench: Bench) -> None:
        future: Future[None] = Future()

        async def wait() -> None:
            await future
            bench.said.append("goes on")

        def first(_: Any) -> None:
            second.publish(Int32())
            if raises:
                raise ValueError("on purpose")

        def give(_: Any) -> None:
            future.set_result(None)
            third.publish(Int32(data=3))

        bench.node.create_subscription(Int32, "first", first, 10)
        bench.node.create_subscription(Int32, "second", give, 10)
        third = bench.hear("third")
        second = bench.node.create_publisher(Int32, "second", 10)
        bench.register()
        bench.executor.create_task(wait)
        bench.node.create_publisher(Int32, "first", 10).publish(Int32())
        with pytest.raises(ValueError, match="on purpose") if raises else nullcontext():
            bench.spin_for(0.5)
        bench.spin_for(0.5)

    assert on_bench(program, distro=distro)[0] == ["goes on", "third3"]
