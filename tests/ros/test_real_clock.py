"""The same model on wall time: strict about order, lenient about times."""

import threading
import time
from collections.abc import Callable

import pytest

import sim.ros as rclpy
from sim.ros.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from sim.ros.executors import Executor, ExternalShutdownException, MultiThreadedExecutor
from sim.ros.interfaces import message, service
from sim.ros.node import Node
from tests.support.simulation import Trace
from tests.support.wall_time import on_wall_time, spin_for

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
            if len(order) == 1:
                for _ in range(3):
                    for publisher in publishers.values():
                        publisher.publish(Int32())
                time.sleep(0.25)

        node.create_timer(0.1, tick)
        spin_for(node, 0.55)
        trace = Trace(simulation.events)
    assert order[:8] == ["tick", "tick", "a", "b", "a", "b", "a", "b"]
    assert trace.times("tick")[1] >= 0.35
    assert len(trace.times("tick")) <= 4


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

    with on_wall_time():
        node = Node("n")
        group = MutuallyExclusiveCallbackGroup()
        for _ in range(4):
            node.create_timer(0.001, work, group)
        spin_for(node, 0.3, MultiThreadedExecutor(4))
    assert worst == 1
    assert ran > 20


def test_a_reentrant_timer_overlaps_itself_on_real_threads() -> None:
    with on_wall_time() as simulation:
        node = Node("n")
        node.create_timer(0.02, lambda: time.sleep(0.1), ReentrantCallbackGroup())
        spin_for(node, 0.3, MultiThreadedExecutor(3))
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
        replies = [client.call(SetBool.Request(), timeout_sec=5.0) for _ in range(200)]
        rclpy.shutdown()
        spinner.join()
        executor.shutdown()
    assert all(isinstance(reply, SetBool.Response) for reply in replies)


@pytest.mark.parametrize("threads", [None, 3])
def test_messages_from_another_thread_arrive_once_and_in_order(threads: int | None) -> None:
    heard: list[int] = []
    with on_wall_time():
        node = Node("n")
        node.create_subscription(Int32, "t", lambda msg: heard.append(msg.data), 1000)
        publisher = node.create_publisher(Int32, "t", 10)
        executor = rclpy.get_global_executor() if threads is None else MultiThreadedExecutor(threads)
        executor.add_node(node)
        spinner = threading.Thread(target=_spin_to_the_end, args=(executor,))
        spinner.start()
        for number in range(500):
            publisher.publish(Int32(data=number))
        deadline = time.monotonic() + 5
        while len(heard) < 500 and time.monotonic() < deadline:
            time.sleep(0.005)
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
