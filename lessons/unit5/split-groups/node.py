"""Drive to an obstacle and turn away, with a group for each callback.

Each of the three groups is mutually exclusive, and the executor has four
threads.
"""

import math
import time

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan

FORWARD_SPEED = 0.08  # metres per second
TURN_SPEED = -0.2  # radians per second; negative turns to the right
FRONT_BEAM = 360  # place of the beam that looks straight ahead
TOO_CLOSE = 0.5  # metres
TIMER_PERIOD = 0.5  # seconds
# Best effort: a scan is sent once, and may get lost.
SCAN_QOS = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)


class SphereAvoider(Node):
    """Drives straight on, and turns away from what is too close."""

    def __init__(self, seconds_sleeping=10):
        super().__init__("sub_node")
        self._seconds_sleeping = seconds_sleeping
        self.laser_msg = LaserScan()  # empty until the first scan comes
        self.yaw = 0.0
        self.vel_pub = self.create_publisher(Twist, "cmd_vel", 10)
        # A seat of its own for each callback.
        self.group1 = MutuallyExclusiveCallbackGroup()
        self.group2 = MutuallyExclusiveCallbackGroup()
        self.group3 = MutuallyExclusiveCallbackGroup()
        self.odom_sub = self.create_subscription(
            Odometry,
            "odom",
            self.odom_callback,
            10,
            callback_group=self.group1,
        )
        self.scan_sub = self.create_subscription(
            LaserScan,
            "scan",
            self.scan_callback,
            SCAN_QOS,
            callback_group=self.group2,
        )
        self.timer = self.create_timer(
            TIMER_PERIOD, self.timer_callback, callback_group=self.group3
        )

    # --- The three callbacks: the executor runs these ---

    def odom_callback(self, msg):
        self.get_logger().info("Odom CallBack")
        self.yaw = yaw_of(msg.pose.pose.orientation)

    def scan_callback(self, msg):
        self.get_logger().info("Scan CallBack")
        self.laser_msg = msg

    def timer_callback(self):
        self.get_logger().info("Timer CallBack")
        front = self.front_range()
        if front is None:
            return  # no scan yet, so nothing to decide on
        self.get_logger().warning(f">>>>>>>>>RANGES Value={front}")
        if front < TOO_CLOSE:
            self.get_logger().info("STOP ROTATE")
            self.stop_robot()
            self.rotate()
        else:
            self.get_logger().info("MOVE STRAIGHT")
            self.move_straight()

    # --- What the callbacks are made of ---

    def front_range(self):
        """Return the metres to what is ahead, None before a scan."""
        ranges = self.laser_msg.ranges
        if len(ranges) <= FRONT_BEAM:
            return None
        return ranges[FRONT_BEAM]

    def rotate(self):
        """Turn for some seconds, and stay in here all that time."""
        seconds = self._seconds_sleeping
        self.send_velocity(0.0, TURN_SPEED)
        self.get_logger().info(f"Rotating for {seconds} seconds")
        for second in range(seconds):
            self.get_logger().info(f"SLEEPING=={second} seconds")
            # One thread sleeps here; the others run odom and scan.
            time.sleep(1)
            if not rclpy.ok():
                return  # Ctrl-C: rclpy no longer publishes
        self.stop_robot()

    def move_straight(self):
        self.send_velocity(FORWARD_SPEED, 0.0)

    def stop_robot(self):
        self.send_velocity(0.0, 0.0)

    def send_velocity(self, forward, turn):
        """Publish a forward speed (m/s) and a turn rate (rad/s)."""
        cmd = Twist()
        cmd.linear.x = forward
        cmd.angular.z = turn
        self.vel_pub.publish(cmd)


def yaw_of(q):
    """Return the heading in radians that a quaternion stands for."""
    return math.atan2(
        2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z)
    )


def main(args=None):
    rclpy.init(args=args)
    node = SphereAvoider()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
