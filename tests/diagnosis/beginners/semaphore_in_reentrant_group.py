import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Feeder(Node):
    def __init__(self):
        super().__init__("feeder")
        group = ReentrantCallbackGroup()
        self.parts = threading.Semaphore(1)
        self.create_timer(0.1, self.take, callback_group=group)
        self.create_timer(1.0, self.bring, callback_group=group)

    def take(self):
        self.parts.acquire()
        self.get_logger().info("took one")

    def bring(self):
        self.parts.release()


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Feeder())
    executor.spin()


if __name__ == "__main__":
    main()
