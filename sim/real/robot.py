"""The lessons' robot as a real ROS 2 node: ``python -m sim.real.robot [RATE]``.

What it publishes, and where it is, it tells on standard output as a probe tells what a program does. Its time
is the machine's monotonic clock.
"""

import importlib
import sys
import time
from collections.abc import Callable
from typing import Any

import msgspec
import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import QoSProfile, ReliabilityPolicy

from sim.real import telling
from sim.robot.driver import Driver
from sim.robot.world import World
from sim.trace.events import AnyEvent


class RealPort:
    """What the driver needs of real rclpy."""

    def __init__(self) -> None:
        self.node: Any = rclpy.create_node("robot_driver")
        self._begun = time.monotonic_ns()

    def now(self) -> int:
        """Nanoseconds since the robot was made."""
        return time.monotonic_ns() - self._begun

    def sleep(self, duration: int) -> None:
        """Wait for so many nanoseconds."""
        time.sleep(duration / 1e9)

    def message(self, package: str, name: str) -> Any:
        """A message class."""
        return getattr(importlib.import_module(f"{package}.msg"), name)

    def service(self, package: str, name: str) -> Any:
        """A service class."""
        return getattr(importlib.import_module(f"{package}.srv"), name)

    def sensor_publisher(self, message: Any, topic: str) -> Any:
        """A publisher that sends without making sure, and keeps five messages."""
        qos = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
        return self.node.create_publisher(message, topic, qos)

    def hear_velocities(self, message: Any, callback: Callable[[Any], None]) -> None:
        """Subscribe to ``cmd_vel``."""
        self.node.create_subscription(message, "cmd_vel", callback, 10)

    def publish(self, publisher: Any, message: Any) -> int:
        """Publish a message, and tell of it; returns its id on the trace."""
        return telling.publish(publisher, publisher.publish, message)

    def record(self, event: AnyEvent) -> None:
        """Tell something of the robot."""
        telling.tell(msgspec.structs.replace(event, t=event.t + self._begun))


def main() -> None:
    """Drive until this process is ended."""
    rclpy.init()
    port = RealPort()
    driver = Driver(port, float(sys.argv[1]) if len(sys.argv) > 1 else None)
    driver.offer()
    driver.begin(World())
    executor = SingleThreadedExecutor()
    executor.add_node(port.node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        return


if __name__ == "__main__":
    main()
