"""What callbacks cost, by one program for real rclpy and for the model: a script, for any Python.

With the argument ``model`` rclpy is the model. Each row prints its name and seconds a callback.
"""

import sys
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

CALLS = 2_000
WARM_UP = 200


def measure() -> None:
    """Measure every row, and print it."""
    import rclpy
    from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
    from rclpy.experimental import EventsExecutor
    from rclpy.task import Future
    from std_msgs.msg import Int32
    from std_srvs.srv import Trigger  # type: ignore[import-untyped]

    def row(name: str, executor: Any, begin: Callable[[Any, Callable[[], None]], None]) -> None:
        """Spin a node until ``count`` was called often enough; ``begin`` gets the node and ``count``."""
        done: Any = Future()
        node = rclpy.create_node(name)
        executor.add_node(node)
        calls, began = 0, 0.0

        def count() -> None:
            nonlocal calls, began
            calls += 1
            if calls == WARM_UP:
                began = time.perf_counter()
            elif calls == WARM_UP + CALLS:
                print(name, (time.perf_counter() - began) / CALLS, flush=True)
                done.set_result(None)

        begin(node, count)
        executor.spin_until_future_complete(done, 60.0)
        executor.shutdown()

    def timer(node: Any, count: Callable[[], None]) -> None:
        node.create_timer(0.0, count)

    def topic(node: Any, count: Callable[[], None]) -> None:
        def heard(message: Any) -> None:
            count()
            publisher.publish(message)

        node.create_subscription(Int32, "topic", heard, 10)
        publisher = node.create_publisher(Int32, "topic", 10)
        publisher.publish(Int32())

    def service(node: Any, count: Callable[[], None]) -> None:
        def ask(_: Any = None) -> None:
            count()
            client.call_async(Trigger.Request()).add_done_callback(ask)

        node.create_service(Trigger, "service", lambda _, response: response)
        client = node.create_client(Trigger, "service")
        client.wait_for_service()
        ask()

    rclpy.init()
    row("zero_timer_single", SingleThreadedExecutor(), timer)
    row("zero_timer_pool_of_4", MultiThreadedExecutor(4), timer)
    row("publish_to_callback_single", SingleThreadedExecutor(), topic)
    row("publish_to_callback_pool_of_4", MultiThreadedExecutor(4), topic)
    row("publish_to_callback_events", EventsExecutor(), topic)
    row("service_round_trip_single", SingleThreadedExecutor(), service)
    with suppress(Exception):
        rclpy.shutdown()


def _become_the_model() -> None:
    from sim.clock import VirtualClock
    from sim.probes.probe import SilentProbe
    from sim.ros import importing
    from sim.ros.middleware.host import Host, install

    importing.install()
    clock = VirtualClock()
    install(Host(clock, SilentProbe(clock)))


if __name__ == "__main__":
    if sys.argv[1:] == ["model"]:
        _become_the_model()
    measure()
