"""Programs that run on both grounds."""

import importlib.util
from pathlib import Path

import msgspec
import pytest

from sim.engine.setup import RealRos, TimedCall
from sim.quantities.nanoseconds import SECOND
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.engine_runs import Run, program_setup, run_to_end

needs_ros = pytest.mark.skipif(
    importlib.util.find_spec("rclpy") is None, reason="no real rclpy: there are no wheels for this Python"
)

HEAD = """
import time
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool
"""
TAIL = """
def main():
    rclpy.init()
    node = Tried()
    executor = {executor}
    executor.add_node(node)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass

if __name__ == "__main__":
    main()
"""

STARVED = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.publisher = self.create_publisher(String, "news", 10)
        self.create_timer(0.1, self.tell, callback_group=MutuallyExclusiveCallbackGroup())
        self.create_timer(1.0, self.work)
        self.create_subscription(String, "news", self.hear, 2)
        self.guard = self.create_guard_condition(self.wake)

    def tell(self):
        self.publisher.publish(String(data="x"))

    def work(self):
        self.get_logger().info("works")
        self.guard.trigger()
        time.sleep(0.7)
        print("worked")

    def hear(self, message):
        pass

    def wake(self):
        pass
"""
CALLS_ITSELF = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_service(SetBool, "switch", self.serve)
        self.client = self.create_client(SetBool, "switch")
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.client.call(SetBool.Request(data=True))

    def serve(self, request, response):
        response.success = True
        return response
"""
WANTS_ONE_MORE = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        groups = [MutuallyExclusiveCallbackGroup() for _ in range(4)]
        self.create_service(SetBool, "switch", self.serve, callback_group=groups[0])
        self.client = self.create_client(SetBool, "switch", callback_group=groups[1])
        self.create_timer(0.5, self.one, callback_group=groups[2])
        self.create_timer(0.5, self.other, callback_group=groups[3])

    def one(self):
        time.sleep(0.4)
        self.client.call(SetBool.Request(data=True))

    def other(self):
        time.sleep(0.2)
        self.client.call(SetBool.Request(data=True))

    def serve(self, request, response):
        return response
"""
AWAITS = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        group = ReentrantCallbackGroup()
        self.create_service(SetBool, "switch", self.serve, callback_group=group)
        self.client = self.create_client(SetBool, "switch", callback_group=group)
        self.create_timer(0.5, self.tick, callback_group=group)

    async def tick(self):
        answer = await self.client.call_async(SetBool.Request(data=True))
        self.get_logger().info("answered " + answer.message)

    def serve(self, request, response):
        time.sleep(0.1)
        response.message = "well"
        return response
"""
NEVER_MATCHES = """
from rclpy.qos import QoSProfile, ReliabilityPolicy

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.publisher = self.create_publisher(String, "news", best_effort)
        self.create_subscription(String, "news", self.hear, 10)
        self.create_timer(0.2, self.tell)

    def tell(self):
        self.publisher.publish(String(data="x"))

    def hear(self, message):
        pass
"""
MISSES_TICKS = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_timer(0.2, self.tick)
        self.create_timer(1.1, self.work)

    def tick(self):
        pass

    def work(self):
        time.sleep(0.75)
"""
RAISES = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_timer(0.5, self.tick)

    def tick(self):
        raise ValueError("no more")
"""
CATCHES = (
    RAISES
    + """
class Catching(MultiThreadedExecutor):
    def spin(self):
        try:
            super().spin()
        except ValueError as error:
            print(f"stopped: {error}")
"""
)
ACTS = """
from rclpy.action import ActionClient, ActionServer
from test_msgs.action import Fibonacci

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.server = ActionServer(self, Fibonacci, "count", self.execute)
        self.client = ActionClient(self, Fibonacci, "count", callback_group=ReentrantCallbackGroup())
        self.once = self.create_timer(0.5, self.ask)

    def execute(self, goal):
        time.sleep(0.5)
        goal.succeed()
        return Fibonacci.Result(sequence=[1, 2])

    def ask(self):
        self.once.cancel()
        self.client.send_goal_async(Fibonacci.Goal(order=3)).add_done_callback(self.accepted)

    def accepted(self, future):
        future.result().get_result_async().add_done_callback(self.done)

    def done(self, future):
        self.get_logger().info("counted")
"""
WAITS_IN_THE_EVENT_QUEUE = """
from rclpy.experimental import EventsExecutor

class Looping:
    def __init__(self):
        self.executor = EventsExecutor()
        self.add_node = self.executor.add_node

    def spin(self):
        while rclpy.ok():
            self.executor.spin_once(timeout_sec=0.1)

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.publisher = self.create_publisher(String, "news", 10)
        self.create_subscription(String, "news", self.hear, 10)
        self.create_timer(0.5, self.tell)

    def tell(self):
        self.publisher.publish(String(data="x"))
        time.sleep(0.4)

    def hear(self, message):
        pass
"""
ALWAYS_DUE = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_timer(0.0, self.tick)

    def tick(self):
        time.sleep(0.1)
"""


RAISES_AT_ITS_END = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_timer(0.1, self.tick)

    def tick(self):
        try:
            time.sleep(10)
        finally:
            raise ValueError("too late")
"""


def run(
    folder: Path,
    body: str,
    executor: str = "SingleThreadedExecutor()",
    *calls: float,
    ground: str = "ros2",
    seconds: float = 3.3,
    threads: int | None = None,
    clock: str = "virtual",
) -> Run:
    """Run a program on a ground for some of its seconds; its service is called at the times given.

    ``threads`` replaces the number of threads of its executor; ``clock`` is the model's.
    """
    path = folder / "tried.py"
    path.write_text(HEAD + body + TAIL.format(executor=executor))
    return run_to_end(
        msgspec.structs.replace(
            program_setup(path, seconds, clock="real" if ground == "ros2" else clock),
            real=RealRos() if ground == "ros2" else None,
            threads=threads,
            calls=tuple(TimedCall(round(at * SECOND), data=True) for at in calls),
        )
    )


def entity_named(name: str, timeline: Timeline) -> int:
    """The entity of a callback of that name, or of a topic or service where it has none."""
    return next(each.id for each in timeline.entities.values() if name in (each.callback, each.name))


def whole(timeline: Timeline) -> Window:
    """From the beginning of a run to its end."""
    return Window(0, timeline.end)
