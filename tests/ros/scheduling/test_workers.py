"""How the workers of a pool share what is ready: who begins what, and that nobody idle is forgotten."""

import threading
from collections.abc import Callable
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.clock import PacedClock
from sim.interfaces import message, service
from sim.ros.entities.publisher import Publisher
from sim.ros.middleware.host_lock import HostLock
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from sim.ros.scheduling.executors import MultiThreadedExecutor
from sim.ros.scheduling.task import Future
from tests.support.real_threads import LIMIT
from tests.support.simulation import Simulation, Trace, installed, no_thread_left, simulate

Int32 = message("std_msgs", "Int32")
Trigger = service("std_srvs", "Trigger")


class LateClock(PacedClock):
    """Wall time on a machine where the second worker gets to run only when ``gate`` opens."""

    def __init__(self) -> None:
        super().__init__()
        self.gate = threading.Event()

    def start_thread(self, target: Callable[[], None], name: str) -> None:
        """Start a thread; the second worker waits first."""

        def run() -> None:
            if name.endswith("_1"):
                self.gate.wait(LIMIT)
            target()

        super().start_thread(run, name)


def test_a_worker_that_comes_free_takes_over_what_another_one_is_late_for() -> None:
    clock = LateClock()
    simulation = Simulation(clock, "jazzy@7.1.12")
    with no_thread_left(), installed(simulation.host):
        node = Node("n")
        ticks: list[str] = []

        def tick(name: str) -> None:
            ticks.append(name)
            if len(ticks) == 20:
                rclpy.shutdown()
                clock.gate.set()

        for name in "abc":
            node.create_timer(0.0, _calling(tick, name), MutuallyExclusiveCallbackGroup())
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()
        executor.shutdown()
    assert "".join(ticks[:18]) == "abc" * 6
    assert {each.thread for each in Trace(simulation.events).calls()} == {"ThreadPoolExecutor-0_0"}


def test_what_a_callback_sends_and_waits_for_is_heard_by_an_idle_worker() -> None:
    simulation = Simulation(PacedClock(), "jazzy@7.1.12")
    with no_thread_left(), installed(simulation.host):
        node = Node("n")
        publisher = node.create_publisher(Int32, "t", 10)
        heard = threading.Semaphore(0)
        node.create_subscription(
            Int32, "t", lambda _: heard.release(), 10, callback_group=MutuallyExclusiveCallbackGroup()
        )
        missed: list[int] = []

        def send() -> None:
            for number in range(300):
                publisher.publish(Int32(data=number))
                if not heard.acquire(timeout=LIMIT):
                    missed.append(number)
                    break
            rclpy.shutdown()

        node.create_guard_condition(send, MutuallyExclusiveCallbackGroup()).trigger()
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()
        executor.shutdown()
    assert missed == []


def test_once_the_future_is_done_workers_begin_nothing_more() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        future: Future[int] = Future()

        def finish() -> None:
            future.set_result(1)
            simulation.sleep(1.0)

        node.create_timer(1.0, finish, MutuallyExclusiveCallbackGroup())
        node.create_timer(0.7, lambda: None, MutuallyExclusiveCallbackGroup())
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin_until_future_complete(future)
        assert simulation.now == 1.0
        simulation.sleep(5.0)

    trace = simulate(program)
    assert [(each.at, each.name) for each in trace.calls()] == [(0.7, "<lambda>"), (1.0, "finish")]


@pytest.mark.parametrize("distro", ["jazzy@7.1.5", "kilted", "jazzy"])
def test_the_worker_of_a_callback_that_raised_serves_what_comes_before_another_one_starts(
    distro: str,
) -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2: 10 runs of 10. Three workers block, the last one is new, and
    # the executor, which waits for its start, begins its next cycle with the task.
    said: list[str] = []

    def program(simulation: Simulation) -> None:
        node, group = Node("n"), ReentrantCallbackGroup()

        def tick() -> None:
            said.append("tick")
            if said == ["tick"]:
                simulation.sleep(0.3)
                raise ValueError("on purpose")
            timer.cancel()
            publisher.publish(Int32())
            for client in clients:
                client.call_async(Trigger.Request())
            simulation.sleep(0.5)

        def hear(_message: object) -> None:
            said.append("hears")
            simulation.sleep(0.5)

        def serve_twice(_request: object, response: Any) -> Any:
            said.append("serves")
            if said.count("serves") == 1:
                simulation.sleep(0.2)
            return response

        def serve(_request: object, response: Any) -> Any:
            executor.create_task(said.append, "task")
            return response

        publisher = node.create_publisher(Int32, "t", 1)
        node.create_subscription(Int32, "t", hear, 1, callback_group=group)
        node.create_service(Trigger, "twice", serve_twice, callback_group=group)
        node.create_service(Trigger, "once", serve, callback_group=group)
        clients = [node.create_client(Trigger, name) for name in ("twice", "twice", "once")]
        timer = node.create_timer(0.2, tick)
        executor = MultiThreadedExecutor(4)
        executor.add_node(node)
        with pytest.raises(ValueError, match="on purpose"):
            executor.spin()
        executor.spin()

    simulate(program, until=1.2, distro=distro)
    assert said == ["tick", "tick", "hears", "serves", "task", "serves"]


def test_the_hosts_lock_lets_one_thread_in_at_a_time_and_itself_again() -> None:
    lock, inside, worst = HostLock(), 0, 0

    def enter() -> None:
        nonlocal inside, worst
        for _ in range(200):
            with lock, lock:
                inside += 1
                worst = max(worst, inside)
                threading.Event().wait(0)
                inside -= 1

    threads = [threading.Thread(target=enter) for _ in range(3)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert (inside, worst) == (0, 1)


def _calling(function: Callable[[str], None], name: str) -> Callable[[], None]:
    return lambda: function(name)


@pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")
def test_a_callback_that_awaits_is_as_old_as_its_handing_over_to_a_pool_that_asks_the_newest_first() -> None:
    # Jazzy, 8 runs of 8: the task that calls the second one is there before the first one makes its own.
    said: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()
        executor = MultiThreadedExecutor(1)
        executor.add_node(node)
        future: Future[None] = Future()

        async def wait(name: str) -> None:
            await future
            said.append(name)

        async def hear(_message: Any) -> None:
            await wait("callback")

        def listen(topic: str, callback: Callable[[Any], Any]) -> Publisher:
            node.create_subscription(Int32, topic, callback, 10, callback_group=group)
            return node.create_publisher(Int32, topic, 10)

        first = listen("first", lambda _: executor.create_task(wait, "task"))
        second = listen("second", hear)

        def begin(_message: Any) -> None:
            first.publish(Int32())
            second.publish(Int32())

        begins = listen("begins", begin)
        simulation.at(0.1, lambda: begins.publish(Int32()))
        simulation.at(0.5, lambda: future.set_result(None))
        simulation.at(0.6, lambda: node.create_timer(1.0, lambda: None))
        executor.spin()

    simulate(program, until=1.0, distro="jazzy@7.1.5")
    assert said == ["task", "callback"]
