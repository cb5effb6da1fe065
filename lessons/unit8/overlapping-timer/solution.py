"""Inspect boxes and count them, one call at a time.

The timer's group lets one call in at a time, and its period leaves a
call the time that it takes.
"""

import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

PERIOD = 1.5  # seconds from one call to the next
INSPECTION = 1.2  # seconds that a box takes


class Inspector(Node):
    """Looks at one box after the other, and counts them."""

    def __init__(self):
        super().__init__("inspector")
        self.boxes = 0
        self.at_work = True
        # One seat: the next call waits until the one before is over.
        self.group = MutuallyExclusiveCallbackGroup()
        self.timer = self.create_timer(
            PERIOD, self.inspect, callback_group=self.group
        )
        self.srv = self.create_service(SetBool, "/work", self.work_callback)

    def inspect(self):
        """Read the count, look at a box, write the count."""
        if not self.at_work:
            return
        seen = self.boxes
        self.get_logger().info(f"reads {seen}")
        time.sleep(INSPECTION)  # nobody else is in here meanwhile
        self.boxes = seen + 1
        self.get_logger().info(f"writes {self.boxes}")

    def work_callback(self, request, response):
        """Begin or stop to look at boxes."""
        self.at_work = request.data
        response.success = True
        response.message = f"{self.boxes} boxes so far"
        return response


def main(args=None):
    rclpy.init(args=args)
    node = Inspector()
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
