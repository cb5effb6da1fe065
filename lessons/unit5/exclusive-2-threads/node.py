"""A service that takes seconds, beside a timer that ticks.

Arguments choose the callback groups and the number of threads, so the
same node shows when a tick has to wait for the service.
"""

import argparse
import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import (
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.utilities import remove_ros_args
from std_srvs.srv import SetBool

TURN_SPEED = -0.2  # radians per second; negative turns to the right


class DummyServer(Node):
    """Turns the robot while it works on a request; says TICK, TACK."""

    def __init__(self, options):
        super().__init__("service_start_turn")
        self.wait_time = options.service_wait_time
        self.timer_flag = True
        # Requests may overlap, so their count is kept under a lock.
        self.requests = 0
        self.requests_lock = threading.Lock()
        self.vel_pub = self.create_publisher(Twist, "cmd_vel", 10)

        self.service_group, self.timer_group = self.make_groups(
            options.callback_group_type
        )
        self.srv = self.create_service(
            SetBool,
            "/dummy_server_srv",
            self.SetBool_callback,
            callback_group=self.service_group,
        )
        self.timer = self.create_timer(
            options.timer_period,
            self.timer_callback,
            callback_group=self.timer_group,
        )

    def make_groups(self, group_type):
        """Return the service's group and the timer's group."""
        log = self.get_logger()
        log.warning(f"Setting {group_type} Groups")
        if group_type == "reentrant":
            # One room for both, with as many seats as there are threads.
            both = ReentrantCallbackGroup()
            log.warning("ReentrantCallbackGroup Set")
            return both, both
        if group_type == "exclusive":
            # Two rooms with one seat each.
            service_group = MutuallyExclusiveCallbackGroup()
            timer_group = MutuallyExclusiveCallbackGroup()
            log.warning("MutuallyExclusiveCallbackGroup Set")
            return service_group, timer_group
        # None means the node's default group: one room, one seat.
        log.error("NO GROUPS SET Set")
        return None, None

    # --- The two callbacks: the executor runs these ---

    def SetBool_callback(self, _request, response):
        """Turn and wait, whether true or false was sent."""
        self.get_logger().warning("Processing Server Message...")
        self.start_turning()
        try:
            self.wait_for_sec(self.wait_time)
        finally:
            self.stop_turning()
        self.get_logger().warning("Processing Server Message...DONE")
        response.success = True
        response.message = "TURNING"
        return response

    def timer_callback(self):
        self.get_logger().info("TICK" if self.timer_flag else "TACK")
        self.timer_flag = not self.timer_flag

    # --- What the callbacks are made of ---

    def wait_for_sec(self, seconds, step=1.0):
        """Sleep in whole steps; the thread is busy all that time."""
        waited = 0
        while waited < seconds and rclpy.ok():
            self.get_logger().info(f"...{waited}[WAITING...]")
            time.sleep(step)
            waited += step

    def start_turning(self):
        with self.requests_lock:
            self.requests += 1
            self.send_turn(TURN_SPEED)

    def stop_turning(self):
        """Stop the robot when no other request still needs it."""
        with self.requests_lock:
            self.requests -= 1
            # After Ctrl-C rclpy no longer publishes.
            if self.requests == 0 and rclpy.ok():
                self.send_turn(0.0)

    def send_turn(self, turn):
        """Publish a turn rate in radians per second."""
        cmd = Twist()
        cmd.angular.z = turn
        self.vel_pub.publish(cmd)


def read_options(words):
    """Read the command line; ROS's own arguments are gone already."""
    parser = argparse.ArgumentParser(
        description="A server to learn callback groups and threads with"
    )
    parser.add_argument(
        "-service_wait_time",
        type=float,
        required=True,
        help="seconds that a request takes",
    )
    parser.add_argument(
        "-timer_period",
        type=float,
        default=1.0,
        help="seconds from tick to tick",
    )
    parser.add_argument(
        "-callback_group_type",
        default="reentrant",
        help="reentrant or exclusive; any other word: no groups",
    )
    parser.add_argument(
        "-threads",
        type=int,
        default=1,
        help="number of threads of the executor",
    )
    options = parser.parse_args(words)
    if options.threads < 1:
        parser.error("-threads has to be 1 or more")
    return options


def main(args=None):
    words = remove_ros_args(args)  # of sys.argv if args is None
    # A list given by hand may lack the program's name in front.
    if words and not words[0].startswith("-"):
        words = words[1:]
    options = read_options(words)

    rclpy.init(args=args)
    node = DummyServer(options)
    threads = options.threads
    node.get_logger().info(f"DummyServer Started with threads={threads}")
    executor = MultiThreadedExecutor(num_threads=threads)
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
