"""Inspect boxes and count them, in calls that overlap each other.

The timer is due twice a second and a call takes longer than that. Its
group is reentrant, so the next call begins beside the one before.
"""

import time

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

PERIOD = 0.5  # seconds from one call to the next
INSPECTION = 1.2  # seconds that a box takes


class Inspector(Node):
    """Looks at one box after the other, and counts them."""

    def __init__(self):
        super().__init__("inspector")
        self.boxes = 0
        self.at_work = True
        # An open area: it lets anyone in, even the same callback again.
        self.group = ReentrantCallbackGroup()
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
        time.sleep(INSPECTION)  # others may read and write meanwhile
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
