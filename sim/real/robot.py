"""The lessons' robot as a real ROS 2 node: ``python -m sim.real.robot RATE PHYSICS``, or ``cbtui robot``.

"" stands for the default rate or physics.

As a part of a run it reports on standard output what it publishes and where it is, in the probe's format. Its
time is the machine's monotonic clock.
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
from sim.real.wire import ProbeLine
from sim.robot.driver import Driver
from sim.robot.physics import PhysicsChoice
from sim.robot.world import World
from sim.trace.events import AnyEvent

Tell = Callable[[ProbeLine], None]


class RealPort:
    """What the driver needs of real rclpy. ``tell`` gets the robot's events.

    With ``transforms`` odometry is also published to ``/tf``.
    """

    def __init__(self, tell: Tell, transforms: type | None = None) -> None:
        self.node: Any = rclpy.create_node("robot_driver")
        self._tell = tell
        self._transforms = transforms
        self._tf = None if transforms is None else self.node.create_publisher(transforms, "/tf", 100)
        self._begun = time.monotonic_ns()

    def now(self) -> int:
        """Nanoseconds since the robot was made."""
        return time.monotonic_ns() - self._begun

    def sleep(self, duration: int) -> None:
        """Sleep for so many nanoseconds."""
        time.sleep(duration / 1e9)

    def message(self, package: str, name: str) -> Any:
        """A message class."""
        return getattr(importlib.import_module(f"{package}.msg"), name)

    def service(self, package: str, name: str) -> Any:
        """A service class."""
        return getattr(importlib.import_module(f"{package}.srv"), name)

    def sensor_publisher(self, message: Any, topic: str) -> Any:
        """A publisher with best-effort QoS and a depth of five."""
        qos = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
        return self.node.create_publisher(message, topic, qos)

    def hear_velocities(self, message: Any, callback: Callable[[Any], None]) -> None:
        """Subscribe to ``cmd_vel``."""
        self.node.create_subscription(message, "cmd_vel", callback, 10)

    def publish(self, publisher: Any, message: Any) -> int:
        """Publish and report a message; returns its id on the trace."""
        if self._tf is not None and hasattr(message, "child_frame_id"):
            self._tf.publish(self._transforms_of(message))
        number, sent = telling.publish(publisher, publisher.publish, message)
        self._tell(sent)
        return number

    def _transforms_of(self, odometry: Any) -> Any:
        """The transforms from odometry to the robot, and from there to the laser at its centre."""
        transform = self.message("geometry_msgs", "TransformStamped")
        robot = transform(header=odometry.header, child_frame_id=odometry.child_frame_id)
        position, where = odometry.pose.pose.position, robot.transform.translation
        where.x, where.y, where.z = position.x, position.y, position.z
        robot.transform.rotation = odometry.pose.pose.orientation
        laser = transform(child_frame_id="base_scan")
        laser.header.stamp, laser.header.frame_id = odometry.header.stamp, odometry.child_frame_id
        assert self._transforms is not None
        return self._transforms(transforms=[robot, laser])

    def record(self, event: AnyEvent) -> None:
        """Report an event of the robot."""
        self._tell(msgspec.structs.replace(event, t=event.t + self._begun))


def transforms() -> type | None:
    """The message class of ``/tf``, if it is installed."""
    try:
        found: type = importlib.import_module("tf2_msgs.msg").TFMessage
    except ImportError:
        return None
    return found


def drive(
    tell: Tell, rate: float | None, transforms: type | None, physics: PhysicsChoice | None = None
) -> None:
    """Drive until Ctrl-C; ``rate`` is that of the sensors in Hz, None for the default."""
    rclpy.init()
    port = RealPort(tell, transforms)
    driver = Driver(port, rate)
    driver.advertise()
    driver.offer()
    driver.begin(World(physics=physics))
    executor = SingleThreadedExecutor()
    executor.add_node(port.node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        return


if __name__ == "__main__":
    rate, physics = sys.argv[1:]
    drive(telling.tell, float(rate) if rate else None, None, PhysicsChoice(physics) if physics else None)
