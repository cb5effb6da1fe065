"""Two timers, and one of them takes its time in a group of its own."""

import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class Blinker(Node):
    """Blinks twice a second, and works now and then."""

    def __init__(self):
        super().__init__("blinker")
        self.blink_group = MutuallyExclusiveCallbackGroup()
        self.work_group = MutuallyExclusiveCallbackGroup()
        self.blink_timer = self.create_timer(0.5, self.blink, self.blink_group)
        self.work_timer = self.create_timer(3.0, self.work, self.work_group)

    def blink(self):
        self.get_logger().info("BLINK")

    def work(self):
        self.get_logger().info("WORK")
        time.sleep(2.0)


def main(args=None):
    rclpy.init(args=args)
    node = Blinker()
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
