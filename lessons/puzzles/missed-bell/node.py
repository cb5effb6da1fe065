import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Bell(Node):
    def __init__(self):
        super().__init__("bell")
        self.bell = threading.Condition()
        group = ReentrantCallbackGroup()
        self.create_timer(0.1, self.hear, callback_group=group)
        self.create_timer(0.1, self.ring, callback_group=group)

    def hear(self):
        with self.bell:
            assert self.bell.wait(0.04), "rung before"

    def ring(self):
        with self.bell:
            self.bell.notify()


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Bell())
    executor.spin()


if __name__ == "__main__":
    main()
