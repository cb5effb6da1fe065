"""Three callbacks, three groups, and an EventsExecutor.

The belt moves on twice a second. An inspection takes over two seconds.
"""

import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool

TIMER_PERIOD = 0.5  # seconds from step to step of the belt
INSPECTION = 2.2  # seconds


class Packing(Node):
    """Moves a belt, inspects parcels, and prints a label for each."""

    def __init__(self):
        super().__init__("packing")
        self.steps = 0
        self.pub = self.create_publisher(String, "/labels", 10)
        # A group for each callback: none shuts another one out.
        self.srv = self.create_service(
            SetBool,
            "/inspect",
            self.inspect_callback,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.sub = self.create_subscription(
            String,
            "/labels",
            self.label_callback,
            10,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.timer = self.create_timer(
            TIMER_PERIOD,
            self.belt_callback,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )

    def belt_callback(self):
        self.steps += 1
        self.get_logger().info(f"STEP {self.steps}")

    def label_callback(self, msg):
        self.get_logger().info(f"LABEL {msg.data}")

    def inspect_callback(self, _request, response):
        """Order a label at once, then inspect: true or false was sent."""
        self.pub.publish(String(data="FRAGILE"))
        self.get_logger().warning("INSPECTING...")
        time.sleep(INSPECTION)
        self.get_logger().warning("INSPECTING...DONE")
        response.success = True
        response.message = "GOOD"
        return response


def main(args=None):
    rclpy.init(args=args)
    node = Packing()
    # One queue for whatever arrives; it never asks a group.
    executor = EventsExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        rclpy.try_shutdown()
        node.destroy_node()


if __name__ == "__main__":
    main()
