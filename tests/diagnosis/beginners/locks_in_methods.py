import threading
import time

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Store(Node):
    def __init__(self):
        super().__init__("store")
        group = ReentrantCallbackGroup()
        self.l1 = threading.Lock()
        self.l2 = threading.Lock()
        self.items = []
        self.money = 0
        self.create_timer(0.3, self.buy, callback_group=group)
        self.create_timer(0.3, self.sell, callback_group=group)

    def buy(self):
        with self.l1:
            time.sleep(0.05)
            self.items.append("apple")
            self.pay()

    def pay(self):
        with self.l2:
            self.money -= 1

    def sell(self):
        with self.l2:
            time.sleep(0.05)
            self.money += 2
            self.hand_over()

    def hand_over(self):
        with self.l1:
            self.items.clear()
            self.get_logger().info("sold")


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Store())
    executor.spin()


if __name__ == "__main__":
    main()
