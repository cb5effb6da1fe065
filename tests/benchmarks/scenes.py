"""Small programs on the real clock, with the trace on, each of which tells what one of its steps took."""

import os
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, TypeAlias

from sim.clock import PacedClock
from sim.interfaces import message, service
from sim.probes.probe import Probe
from sim.ros.context.context import Context
from sim.ros.middleware.host import Host
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.ros.scheduling.events_executor import EventsExecutor
from sim.ros.scheduling.executors import (
    Executor,
    ExternalShutdownException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
)
from sim.trace.events import AnyEvent

MakeExecutor: TypeAlias = Callable[[Context], Executor]
Scene: TypeAlias = Callable[[MakeExecutor, int], float]
"""Runs so many steps on an executor and returns the seconds that one took."""


def single(context: Context) -> Executor:
    """A SingleThreadedExecutor."""
    return SingleThreadedExecutor(context=context)


def events(context: Context) -> Executor:
    """An EventsExecutor."""
    return EventsExecutor(context=context)


def multi(threads: int) -> MakeExecutor:
    """Makes MultiThreadedExecutors."""
    return lambda context: MultiThreadedExecutor(threads, context=context)


class Stage:
    """A node whose callbacks count, and whose executor stops after ``calls`` of them."""

    def __init__(self, make_executor: MakeExecutor, calls: int) -> None:
        self.trace: deque[AnyEvent] = deque(maxlen=100_000)
        self.clock = PacedClock()
        self.context = Context(host=Host(self.clock, Probe(self.clock, self.trace.append)))
        self.context.init([])
        self.node = Node("stage", context=self.context)
        self.executor = make_executor(self.context)
        self.executor.add_node(self.node)
        self.calls = calls
        self.counted = 0

    def count(self, _message: Any = None) -> None:
        """Take one more call; end the run with the last."""
        self.counted += 1
        if self.counted == self.calls:
            self.context.shutdown()

    def spin(self) -> float:
        """Spin until the run ends; returns the seconds it took."""
        began = time.perf_counter()
        with suppress(ExternalShutdownException):
            self.executor.spin()
        took = time.perf_counter() - began
        self.end()
        return took

    def end(self) -> None:
        """Leave nothing behind."""
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()


def one_timer(make_executor: MakeExecutor, calls: int) -> float:
    """A timer of period zero."""
    return timer_among(0)(make_executor, calls)


def timer_among(subscriptions: int) -> Scene:
    """A timer of period zero, in a node that has so many subscriptions to which nothing comes."""

    def run(make_executor: MakeExecutor, calls: int) -> float:
        stage = Stage(make_executor, calls)
        stage.node.create_timer(0.0, stage.count)
        for number in range(subscriptions):
            stage.node.create_subscription(message("std_msgs", "Int32"), f"t{number}", stage.count, 10)
        return stage.spin() / calls

    return run


def four_timers(make_executor: MakeExecutor, calls: int) -> float:
    """Four timers of period zero, each in a group of its own."""
    stage = Stage(make_executor, calls)
    for _ in range(4):
        stage.node.create_timer(0.0, stage.count, MutuallyExclusiveCallbackGroup())
    return stage.spin() / calls


def subscriptions(number: int) -> Scene:
    """A topic with so many subscriptions; the last to be served publishes the next message."""

    def run(make_executor: MakeExecutor, calls: int) -> float:
        stage = Stage(make_executor, calls)
        integer: Any = message("std_msgs", "Int32")
        publisher = stage.node.create_publisher(integer, "n", 10)
        sent = integer(data=1)

        def on_number(_: Any) -> None:
            stage.count()
            if stage.counted % number == 0 and stage.counted < calls:
                publisher.publish(sent)

        for _ in range(number):
            stage.node.create_subscription(integer, "n", on_number, 10)
        publisher.publish(sent)
        return stage.spin() / calls

    return run


def _served(make_executor: MakeExecutor, calls: int) -> tuple[Stage, Callable[[], Any], Callable[[], Any]]:
    """A stage with a service, and the two ways to call it: asynchronously, and waiting."""
    stage = Stage(make_executor, calls)
    empty: Any = service("std_srvs", "Empty")
    stage.node.create_service(empty, "e", lambda _request, response: response)
    client = stage.node.create_client(empty, "e")
    return stage, lambda: client.call_async(empty.Request()), lambda: client.call(empty.Request())


def calls_in_a_row(make_executor: MakeExecutor, calls: int) -> float:
    """A service that is called again as soon as it has answered, by the callback of the future."""
    stage, call, _ = _served(make_executor, calls)

    def again(_: Any) -> None:
        stage.count()
        call().add_done_callback(again)

    again(None)
    return stage.spin() / calls


def calls_awaited(make_executor: MakeExecutor, calls: int) -> float:
    """A service whose answer is waited for by spinning until the future is done."""
    stage, call, _ = _served(make_executor, calls)
    began = time.perf_counter()
    for _ in range(calls):
        stage.executor.spin_until_future_complete(call())
    took = time.perf_counter() - began
    stage.end()
    return took / calls


def calls_from_another_thread(make_executor: MakeExecutor, calls: int) -> float:
    """A service that a thread calls which does not spin, waiting for each answer."""
    stage, _, call = _served(make_executor, calls)

    def call_all() -> None:
        for _ in range(calls):
            call()
            stage.count()

    caller = threading.Thread(target=call_all)
    caller.start()
    took = stage.spin()
    caller.join()
    return took / calls


def lateness(make_executor: MakeExecutor, calls: int) -> float:
    """The 99th percentile of the seconds by which a timer of 1 ms is late."""
    stage = Stage(make_executor, calls)
    late: list[int] = []

    def tick() -> None:
        late.append(stage.clock.now() - (timer.due - timer.period))
        stage.count()

    timer = stage.node.create_timer(0.001, tick)
    stage.spin()
    return sorted(late)[len(late) * 99 // 100] / 1e9


def idle_timers(make_executor: MakeExecutor, calls: int) -> float:
    """The share of a core that five timers of 100 Hz take which do nothing."""
    stage = Stage(make_executor, calls)
    for _ in range(5):
        stage.node.create_timer(0.01, stage.count)
    before = os.times()
    took = stage.spin()
    after = os.times()
    return (after.user - before.user + after.system - before.system) / took


@contextmanager
def pinned() -> Iterator[None]:
    """Keep this thread, and those that it starts, to one core."""
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, cores)
