import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Bank(Node):
    def __init__(self):
        super().__init__("bank")
        self.one, self.two = threading.Lock(), threading.Lock()
        group = ReentrantCallbackGroup()
        self.create_timer(0.1, self.forth, callback_group=group)
        self.create_timer(0.1, self.back, callback_group=group)

    def forth(self):
        with self.one:
            with self.two:
                self.get_logger().info("forth")

    def back(self):
        with self.two:
            with self.one:
                self.get_logger().info("back")


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Bank())
    executor.spin()


if __name__ == "__main__":
    main()
