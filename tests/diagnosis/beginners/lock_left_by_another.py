import threading

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Store(Node):
    def __init__(self):
        super().__init__("store")
        self.lock = threading.Lock()
        self.parts = []
        self.create_timer(0.3, self.fill, MutuallyExclusiveCallbackGroup())
        self.create_timer(0.4, self.empty, MutuallyExclusiveCallbackGroup())

    def fill(self):
        self.lock.acquire()
        self.parts.append("part")
        self.lock.release()

    def empty(self):
        self.lock.acquire()
        if len(self.parts) > 1:
            return
        self.parts.clear()
        self.lock.release()


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(2)
    executor.add_node(Store())
    executor.spin()


if __name__ == "__main__":
    main()
