"""What a callback costs on the real clock, with the trace on: ``pytest tests/benchmarks --benchmark-only``.

Compare within one run only: machines differ, and the same one differs from minute to minute. The first
benchmark is the yardstick, one turn of a queue and a call of an empty function.
"""

from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from sim.clock import RealClock
from sim.ros.callback_groups import MutuallyExclusiveCallbackGroup
from sim.ros.context import Context
from sim.ros.executors import (
    Executor,
    ExternalShutdownException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
)
from sim.ros.host import Host
from sim.ros.interfaces import message, service
from sim.ros.node import Node
from sim.ros.probe import Probe
from sim.trace.events import AnyEvent

CALLBACKS = 5_000


class _Bench:
    """A node whose callbacks count, and whose executor stops after ``CALLBACKS`` of them."""

    def __init__(self, make_executor: Callable[[Context], Executor]) -> None:
        self.trace: deque[AnyEvent] = deque(maxlen=100_000)
        clock = RealClock()
        self.context = Context(host=Host(clock, Probe(clock, self.trace.append)))
        self.context.init([])
        self.node = Node("bench", context=self.context)
        self.executor = make_executor(self.context)
        self.executor.add_node(self.node)
        self.calls = 0

    def count(self, _message: Any = None) -> None:
        self.calls += 1
        if self.calls == CALLBACKS:
            self.context.shutdown()

    def spin(self) -> None:
        with suppress(ExternalShutdownException):
            self.executor.spin()
        self.executor.shutdown()


def _single(context: Context) -> Executor:
    return SingleThreadedExecutor(context=context)


def _multi(context: Context) -> Executor:
    return MultiThreadedExecutor(4, context=context)


EXECUTORS = pytest.mark.parametrize("make_executor", [_single, _multi], ids=["single", "multi4"])


def test_yardstick(benchmark: BenchmarkFixture) -> None:
    queue: deque[int] = deque()

    def empty() -> None:
        return None

    def turns() -> None:
        for _ in range(CALLBACKS):
            queue.append(1)
            queue.popleft()
            empty()

    benchmark(turns)


@EXECUTORS
def test_zero_period_timer(benchmark: BenchmarkFixture, make_executor: Callable[[Context], Executor]) -> None:
    def run() -> None:
        bench = _Bench(make_executor)
        bench.node.create_timer(0.0, bench.count)
        bench.spin()

    benchmark.pedantic(run, rounds=5, warmup_rounds=1)


@EXECUTORS
def test_four_timers_in_four_groups(
    benchmark: BenchmarkFixture, make_executor: Callable[[Context], Executor]
) -> None:
    def run() -> None:
        bench = _Bench(make_executor)
        for _ in range(4):
            bench.node.create_timer(0.0, bench.count, MutuallyExclusiveCallbackGroup())
        bench.spin()

    benchmark.pedantic(run, rounds=5, warmup_rounds=1)


@EXECUTORS
def test_publish_to_callback(
    benchmark: BenchmarkFixture, make_executor: Callable[[Context], Executor]
) -> None:
    def run() -> None:
        bench = _Bench(make_executor)
        number: Any = message("std_msgs", "Int32")
        publisher = bench.node.create_publisher(number, "n", 10)
        sent = number(data=1)

        def on_number(_: Any) -> None:
            bench.count()
            publisher.publish(sent)

        bench.node.create_subscription(number, "n", on_number, 10)
        publisher.publish(sent)
        bench.spin()

    benchmark.pedantic(run, rounds=5, warmup_rounds=1)


@EXECUTORS
def test_service_round_trip(
    benchmark: BenchmarkFixture, make_executor: Callable[[Context], Executor]
) -> None:
    def run() -> None:
        bench = _Bench(make_executor)
        empty: Any = service("std_srvs", "Empty")
        bench.node.create_service(empty, "e", lambda _request, response: response)
        client = bench.node.create_client(empty, "e")

        def again(_: Any) -> None:
            bench.count()
            client.call_async(empty.Request()).add_done_callback(again)

        again(None)
        bench.spin()

    benchmark.pedantic(run, rounds=3, warmup_rounds=1)
