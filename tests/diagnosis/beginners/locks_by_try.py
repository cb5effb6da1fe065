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
        self.create_timer(0.5, self.earn, callback_group=group)
        self.create_timer(0.5, self.spend, callback_group=group)

    def earn(self):
        self.a.acquire()
        try:
            time.sleep(0.1)
            self.b.acquire()
            try:
                self.get_logger().info("earn")
            finally:
                self.b.release()
        finally:
            self.a.release()

    def spend(self):
        self.b.acquire()
        try:
            time.sleep(0.1)
            self.a.acquire()
            try:
                self.get_logger().info("spend")
            finally:
                self.a.release()
        finally:
            self.b.release()


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(4)
    executor.add_node(Bank())
    executor.spin()


if __name__ == "__main__":
    main()
