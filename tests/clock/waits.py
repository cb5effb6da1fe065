"""Ways to wait for some seconds, by name: Python's own and rclpy's."""

import asyncio
import concurrent.futures
import queue
import sched
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from typing import Any, TypeAlias

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.ros.clocks.clock import Clock, ClockType
from sim.ros.rclpy._entities.wait_for_message import wait_for_message
from sim.ros.scheduling.executors import MultiThreadedExecutor, SingleThreadedExecutor
from sim.ros.scheduling.task import Future
from sim.ros.time.duration import Duration
from sim.ros.time.time import Time

Later: TypeAlias = Callable[[Callable[[], object]], None]
"""Has something done while a wait goes on, if anything is to be done meanwhile."""
Body: TypeAlias = Callable[[float, Later], object]
"""Waits some seconds, or until what it told ``Later`` to do has been done."""

WAITS: dict[str, Body] = {}
WAITS_OUT: set[str] = set()
"""Those that nothing ends early."""
BEHIND = "behind"
"""How the names of those end that wait until their deadline is behind them, and not only reached."""


def _waits(body: Body) -> Body:
    WAITS[body.__name__.strip("_")] = body
    return body


def _waits_out(body: Callable[[float], object]) -> None:
    name = body.__name__.strip("_")
    WAITS[name] = lambda seconds, _later: body(seconds)
    WAITS_OUT.add(name)


@_waits_out
def _sleep(seconds: float) -> None:
    time.sleep(seconds)


@_waits_out
def _sleep_what_is_left(seconds: float) -> None:
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        time.sleep(left)


@_waits_out
def _sleep_a_bit_until_behind(seconds: float) -> None:
    end = time.perf_counter() + seconds
    while time.perf_counter() <= end:
        time.sleep(max(0.0, min(0.05, end - time.perf_counter())))


@_waits_out
def _ask_an_event_until_behind(seconds: float) -> None:
    event, end = threading.Event(), time.monotonic() + seconds
    while time.monotonic() <= end:
        event.wait(max(0.0, end - time.monotonic()))


@_waits_out
def _try_a_lock_until_behind(seconds: float) -> None:
    lock, end = threading.Lock(), time.monotonic() + seconds
    lock.acquire()
    time.sleep(seconds)
    while time.monotonic() <= end:
        lock.acquire(blocking=False)


@_waits_out
def _a_timer(seconds: float) -> None:
    timer = threading.Timer(seconds, int)
    timer.start()
    timer.join()


@_waits_out
def _a_schedule(seconds: float) -> None:
    schedule = sched.scheduler(time.monotonic, time.sleep)
    schedule.enter(seconds, 1, int)
    schedule.run()


@_waits_out
def _asyncio_sleep(seconds: float) -> None:
    asyncio.run(asyncio.sleep(seconds))


def _get(kind: str) -> Body:
    def get(seconds: float, later: Later) -> None:
        box = getattr(queue, kind)()
        later(lambda: box.put(1))
        with suppress(queue.Empty):
            box.get(timeout=seconds)

    return get


WAITS |= {f"{kind}_get": _get(kind) for kind in ("Queue", "PriorityQueue", "LifoQueue", "SimpleQueue")}


@_waits
def _queue_put(seconds: float, later: Later) -> None:
    box: queue.Queue[int] = queue.Queue(1)
    box.put(1)
    later(box.get)
    with suppress(queue.Full):
        box.put(2, timeout=seconds)


@_waits
def _lock(seconds: float, later: Later) -> None:
    lock = threading.Lock()
    lock.acquire()
    later(lock.release)
    lock.acquire(timeout=seconds)


@_waits
def _condition(seconds: float, later: Later) -> None:
    condition = threading.Condition()

    def notify() -> None:
        with condition:
            condition.notify()

    later(notify)
    with condition:
        condition.wait(seconds)


@_waits
def _condition_for(seconds: float, later: Later) -> None:
    condition, box = threading.Condition(), []

    def notify() -> None:
        with condition:
            box.append(1)
            condition.notify()

    later(notify)
    with condition:
        condition.wait_for(lambda: box, seconds)


@_waits
def _semaphore(seconds: float, later: Later) -> None:
    semaphore = threading.Semaphore(0)
    later(semaphore.release)
    semaphore.acquire(timeout=seconds)


@_waits
def _event(seconds: float, later: Later) -> None:
    event = threading.Event()
    later(event.set)
    event.wait(seconds)


@_waits
def _barrier(seconds: float, later: Later) -> None:
    barrier = threading.Barrier(2)
    later(barrier.wait)
    with suppress(threading.BrokenBarrierError):
        barrier.wait(seconds)


@_waits
def _join(seconds: float, later: Later) -> None:
    end = threading.Event()
    thread = threading.Thread(target=end.wait)
    thread.start()
    later(end.set)
    thread.join(seconds)
    end.set()


@contextmanager
def _future(later: Later) -> Iterator["concurrent.futures.Future[int]"]:
    future: concurrent.futures.Future[int] = concurrent.futures.Future()
    later(lambda: future.set_result(1))
    with suppress(TimeoutError):
        yield future


@_waits
def _future_result(seconds: float, later: Later) -> None:
    with _future(later) as future:
        future.result(seconds)


@_waits
def _futures_wait(seconds: float, later: Later) -> None:
    with _future(later) as future:
        concurrent.futures.wait([future], seconds)


@_waits
def _as_completed_behind(seconds: float, later: Later) -> None:
    with _future(later) as future:
        list(concurrent.futures.as_completed([future], seconds))


@_waits
def _asyncio_wait_for(seconds: float, later: Later) -> None:
    async def wait() -> None:
        event, loop = asyncio.Event(), asyncio.get_running_loop()
        later(lambda: loop.is_closed() or loop.call_soon_threadsafe(event.set))
        with suppress(TimeoutError):
            await asyncio.wait_for(event.wait(), seconds)

    asyncio.run(wait())


# rclpy's


@cache
def _node() -> Any:
    rclpy.init()
    return rclpy.create_node("waits")


@_waits
def _spin_until_future_complete(seconds: float, later: Later) -> None:
    future: Future[int] = Future()
    later(lambda: future.set_result(1))
    rclpy.spin_until_future_complete(_node(), future, SingleThreadedExecutor(), seconds)


@_waits_out
def _spin_once(seconds: float) -> None:
    rclpy.spin_once(_node(), timeout_sec=seconds)


@_waits_out
def _spin_what_is_left(seconds: float) -> None:
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        _spin_once_of_several_threads(left)


@_waits_out
def _spin_until_behind(seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() <= end:
        rclpy.spin_once(_node(), timeout_sec=max(0.0, end - time.monotonic()))


def _spin_once_of_several_threads(seconds: float) -> None:
    executor = MultiThreadedExecutor(2)
    executor.add_node(_node())
    executor.spin_once(timeout_sec=seconds)
    executor.remove_node(_node())


@_waits_out
def _sleep_for(seconds: float) -> None:
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        _node().get_clock().sleep_for(Duration(seconds=left))


@_waits_out
def _sleep_until_behind(seconds: float) -> None:
    _node()  # which begins the context
    clock, end = Clock(clock_type=ClockType.STEADY_TIME), time.monotonic() + seconds
    while time.monotonic() < end:
        clock.sleep_until(Time(seconds=end, clock_type=ClockType.STEADY_TIME))


@_waits
def _wait_for_message(seconds: float, later: Later) -> None:
    empty = message("std_msgs", "Empty")
    publisher = _node().create_publisher(empty, "/topic", 1)
    later(lambda: publisher.publish(empty()))
    wait_for_message(empty, _node(), "/topic", time_to_wait=seconds)
    _node().destroy_publisher(publisher)


@_waits_out
def _call(seconds: float) -> None:
    empty = service("std_srvs", "Empty")
    client = _node().create_client(empty, "/nobody")
    client.call(empty.Request(), timeout_sec=seconds)
    _node().destroy_client(client)
