import threading
import time

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Bank(Node):
    def __init__(self):
        super().__init__("bank")
        self.a = threading.Lock()
        self.b = threading.Lock()
        group = ReentrantCallbackGroup()
        self.create_timer(0.3, self.pay, callback_group=group)
        self.create_timer(0.3, self.earn, callback_group=group)

    def pay(self):
        self.a.acquire()
        time.sleep(0.05)
        self.b.acquire()
        self.get_logger().info("paid")
        self.b.release()
        self.a.release()

    def earn(self):
        self.b.acquire()
        time.sleep(0.05)
        self.a.acquire()
        self.get_logger().info("earned")
        self.a.release()
        self.b.release()


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Bank())
    executor.spin()


if __name__ == "__main__":
    main()
