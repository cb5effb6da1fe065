"""A printer that is switched off in the middle of a page: yours to mend.

Have a page that was begun printed to its end, and none begun after the
printer was switched off. Its lamp blinks on.
"""

import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

PAGE_PERIOD = 2.0  # seconds from page to page
PRINTING = 1.2  # seconds


class Printer(Node):
    """Prints a page every two seconds, until it is switched off."""

    def __init__(self):
        super().__init__("printer")
        self.pages = 0
        self.page_pub = self.create_publisher(Int32, "pages", 10)
        # Who may be at work while the printer is switched off?
        self.page_timer = self.create_timer(
            PAGE_PERIOD,
            self.print_callback,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.srv = self.create_service(
            SetBool,
            "/switch_off",
            self.off_callback,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.lamp_timer = self.create_timer(0.5, self.lamp_callback)

    def lamp_callback(self):
        self.get_logger().info("BLINK")

    def print_callback(self):
        """Print a page, and tell its number."""
        self.pages += 1
        self.get_logger().info(f"PAGE {self.pages}...")
        time.sleep(PRINTING)
        self.page_pub.publish(Int32(data=self.pages))
        self.get_logger().info(f"PAGE {self.pages}...DONE")

    def off_callback(self, _request, response):
        """Switch off for good, whether true or false was sent."""
        self.destroy_timer(self.page_timer)
        self.destroy_publisher(self.page_pub)
        self.get_logger().warning("SWITCHED OFF")
        response.success = True
        return response


def main(args=None):
    rclpy.init(args=args)
    node = Printer()
    executor = MultiThreadedExecutor(num_threads=2)
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
