"""The same model on wall time: strict about order; times are never early, however late the machine is."""

import threading
import time
from collections.abc import Callable
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from sim.ros.scheduling.executors import Executor, ExternalShutdownException, MultiThreadedExecutor
from tests.support.real_threads import LIMIT, on_wall_time, spin
from tests.support.simulation import Trace

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")


def test_a_blocked_timer_drops_ticks_and_messages_wait_in_the_order_of_rclpy() -> None:
    with on_wall_time() as simulation:
        node = Node("n")
        order: list[str] = []
        publishers = {topic: node.create_publisher(Int32, topic, 10) for topic in "ab"}
        for topic in "ab":
            node.create_subscription(Int32, topic, _appending(order, topic), 10)

        def tick() -> None:
            order.append("tick")
            if order.count("tick") >= 3 and len(order) - order.count("tick") == 6:
                rclpy.shutdown()
            if len(order) == 1:
                for _ in range(3):
                    for publisher in publishers.values():
                        publisher.publish(Int32())
                time.sleep(0.25)

        node.create_timer(0.1, tick)
        spin(node)
        trace = Trace(simulation.events)
    assert order[:2] == ["tick", "tick"]
    assert [name for name in order if name != "tick"] == ["a", "b"] * 3
    first, late, following = trace.times("tick")[:3]
    assert first >= 0.1
    assert late >= first + 0.25
    assert following >= 0.4


def test_callbacks_of_exclusive_groups_never_overlap_on_real_threads() -> None:
    inside, worst, ran = 0, 0, 0
    guard = threading.Lock()

    def work() -> None:
        nonlocal inside, worst, ran
        with guard:
            inside += 1
            worst = max(worst, inside)
            ran += 1
        time.sleep(0.0005)
        with guard:
            inside -= 1
        if ran == 100:
            rclpy.shutdown()

    with on_wall_time():
        node = Node("n")
        group = MutuallyExclusiveCallbackGroup()
        for _ in range(4):
            node.create_timer(0.001, work, group)
        spin(node, MultiThreadedExecutor(4))
    assert worst == 1
    assert ran >= 100


def test_a_reentrant_timer_overlaps_itself_on_real_threads() -> None:
    with on_wall_time() as simulation:
        node = Node("n")
        together = threading.Barrier(3, action=rclpy.shutdown)

        def meet() -> None:
            if rclpy.ok():
                together.wait(LIMIT)

        node.create_timer(0.02, meet, ReentrantCallbackGroup())
        spin(node, MultiThreadedExecutor(3))
        trace = Trace(simulation.events)
    assert {each.thread for each in trace.calls()} == {f"ThreadPoolExecutor-0_{n}" for n in range(3)}


def test_many_calls_of_a_service_on_real_threads_are_all_answered() -> None:
    with on_wall_time():
        node = Node("n")
        group = ReentrantCallbackGroup()
        node.create_service(SetBool, "s", lambda _, response: response, callback_group=group)
        client = node.create_client(SetBool, "s", callback_group=group)
        executor = MultiThreadedExecutor(3)
        executor.add_node(node)
        spinner = threading.Thread(target=executor.spin)
        spinner.start()
        replies = [client.call(SetBool.Request(), timeout_sec=LIMIT) for _ in range(200)]
        rclpy.shutdown()
        spinner.join()
        executor.shutdown()
    assert all(isinstance(reply, SetBool.Response) for reply in replies)


@pytest.mark.parametrize("threads", [None, 3])
def test_messages_from_another_thread_arrive_once_and_in_order(threads: int | None) -> None:
    heard: list[int] = []
    all_heard = threading.Event()

    def hear(msg: Any) -> None:
        heard.append(msg.data)
        if len(heard) == 500:
            all_heard.set()

    with on_wall_time():
        node = Node("n")
        node.create_subscription(Int32, "t", hear, 1000)
        publisher = node.create_publisher(Int32, "t", 10)
        executor = rclpy.get_global_executor() if threads is None else MultiThreadedExecutor(threads)
        executor.add_node(node)
        spinner = threading.Thread(target=_spin_to_the_end, args=(executor,))
        spinner.start()
        for number in range(500):
            publisher.publish(Int32(data=number))
        all_heard.wait(LIMIT)
        rclpy.shutdown()
        spinner.join()
        executor.shutdown()
    assert heard == list(range(500))


def _spin_to_the_end(executor: Executor) -> None:
    try:
        executor.spin()
    except ExternalShutdownException:
        return


def _appending(to: list[str], text: str) -> Callable[[object], None]:
    return lambda _: to.append(text)
