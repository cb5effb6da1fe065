"""The robot's driver: a node of its own that offers the robot's world on topics and services.

It runs like the driver process of a real robot: its callbacks are not on the lanes, its messages are.
"""

import array
import math
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sim.robot.arena import ARENA, ROBOT_RADIUS
from sim.robot.lidar import ANGLE_INCREMENT, ANGLE_MIN, RANGE_MAX, RANGE_MIN
from sim.robot.world import World
from sim.trace.events import AnyEvent, ArenaShown, RobotMoved, Scanned, VelocityCommanded

SENSOR_RATE = 20.0
"""Measurements a second of each sensor, unless a run wants others."""

_LATENCY = 3_000_000
"""Nanoseconds from a tick to the odometry, and from that to the scan, as reading a sensor takes time."""


class Port(Protocol):
    """The interface of a driver to rclpy, modelled or real."""

    @property
    def node(self) -> Any:
        """The driver's node."""

    def now(self) -> int:
        """Nanoseconds of the run's time."""

    def sleep(self, duration: int) -> None:
        """Wait for a number of nanoseconds of the run's time."""

    def message(self, package: str, name: str) -> Any:
        """Return a message class."""

    def service(self, package: str, name: str) -> Any:
        """Return a service class."""

    def sensor_publisher(self, message: Any, topic: str) -> Any:
        """Create a best-effort publisher that keeps five messages."""

    def hear_velocities(self, message: Any, callback: Callable[[Any], None]) -> None:
        """Subscribe to ``cmd_vel``."""

    def publish(self, publisher: Any, message: Any) -> int:
        """Publish a message; returns its id on the trace."""

    def record(self, event: AnyEvent) -> None:
        """Record an event of the robot."""


class Driver:
    """Drives a robot. ``rate`` (Hz) is that of odometry and scans; None: the usual one."""

    def __init__(self, port: Port, rate: float | None = None) -> None:
        self._tick = 1 / (rate or SENSOR_RATE)
        self._port = port
        self._record = port.record
        self._node = port.node
        self._odometry = port.message("nav_msgs", "Odometry")
        self._laser_scan = port.message("sensor_msgs", "LaserScan")
        self._warned = False
        self._scan: Any = None

    def advertise(self) -> None:
        """Offer the topics of the sensors, unless that is done."""
        if self._scan is None:
            self._odom = self._node.create_publisher(self._odometry, "odom", 10)
            self._scan = self._port.sensor_publisher(self._laser_scan, "scan")

    def offer(self) -> None:
        """Offer all but the topics of the sensors, and record the robot's surroundings."""
        node, port = self._node, self._port
        port.hear_velocities(port.message("geometry_msgs", "Twist"), self._on_velocity)
        node.create_service(port.service("std_srvs", "Empty"), "reset_world", self._on_reset)
        node.create_service(port.service("std_srvs", "SetBool"), "motor_power", self._on_motor_power)
        self._record(
            ArenaShown(
                port.now(),
                tuple((wall.x0, wall.y0, wall.x1, wall.y1) for wall in ARENA.walls),
                (ARENA.sphere.x, ARENA.sphere.y, ARENA.sphere.radius),
                ROBOT_RADIUS,
            )
        )

    def begin(self, world: World) -> None:
        """Start the sensors, which measure while the node is spun."""
        self._world = world
        self._port.sleep(_LATENCY)
        self.advertise()
        self._node.create_timer(self._tick, self._publish_odometry)
        self._port.sleep(_LATENCY)
        self._node.create_timer(self._tick, self._publish_scan)

    def _catch_up(self) -> World:
        self._world.advance_to(self._port.now())
        return self._world

    def _on_velocity(self, command: Any) -> None:
        world = self._catch_up()
        if world.command(command.linear.x, command.angular.z):
            now = self._port.now()
            self._record(VelocityCommanded(now, world.commanded.linear, world.commanded.angular))
        elif not self._warned:
            self._warned = True
            self._node.get_logger().warning(
                f"Ignored a velocity that is no number: linear.x={command.linear.x}, "
                f"angular.z={command.angular.z}; publish finite ones. More of them are ignored silently."
            )

    def _on_reset(self, _request: Any, response: Any) -> Any:
        self._catch_up().reset()
        return response

    def _on_motor_power(self, request: Any, response: Any) -> Any:
        self._catch_up().set_motors(request.data)
        response.success = True
        response.message = "motors on" if request.data else "motors off"
        return response

    def _publish_odometry(self) -> None:
        world = self._catch_up()
        pose, velocity = world.pose(), world.velocity()
        odometry = self._odometry()
        odometry.header.stamp = self._node.get_clock().now().to_msg()
        odometry.header.frame_id = "odom"
        odometry.child_frame_id = "base_footprint"
        odometry.pose.pose.position.x = pose.x
        odometry.pose.pose.position.y = pose.y
        odometry.pose.pose.orientation.z = math.sin(pose.yaw / 2)
        odometry.pose.pose.orientation.w = math.cos(pose.yaw / 2)
        odometry.twist.twist.linear.x = velocity.linear
        odometry.twist.twist.angular.z = velocity.angular
        self._port.publish(self._odom, odometry)

    def _publish_scan(self) -> None:
        world = self._catch_up()
        ranges = world.scan()
        scan = self._laser_scan(
            angle_min=ANGLE_MIN,
            angle_max=ANGLE_MIN + (len(ranges) - 1) * ANGLE_INCREMENT,
            angle_increment=ANGLE_INCREMENT,
            scan_time=self._tick,
            range_min=RANGE_MIN,
            range_max=RANGE_MAX,
            ranges=array.array("f", ranges.tobytes()),
        )
        scan.header.stamp = self._node.get_clock().now().to_msg()
        scan.header.frame_id = "base_scan"
        now = self._port.now()
        sent = self._port.publish(self._scan, scan)
        self._record(Scanned(now, sent, _packed(ranges)))
        self._record(self._moved(now, world, float(ranges[len(ranges) // 2])))

    def _moved(self, now: int, world: World, front: float) -> RobotMoved:
        pose, velocity = world.pose(), world.velocity()
        return RobotMoved(
            now,
            pose.x,
            pose.y,
            pose.yaw,
            front,
            velocity.linear,
            velocity.angular,
            world.motors_on,
            world.touching(),
            world.turned,
            world.travelled,
        )


def _packed(ranges: NDArray[np.float32]) -> bytes:
    """Encode ranges as the trace has them: little-endian uint16 millimetres, 0 for nothing in range."""
    return np.where(np.isfinite(ranges), np.rint(ranges * 1000), 0).astype("<u2").tobytes()
