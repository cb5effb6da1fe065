import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Table(Node):
    def __init__(self):
        super().__init__("table")
        self.forks = [threading.Lock() for _ in range(3)]
        group = ReentrantCallbackGroup()
        self.create_timer(0.1, self.ann, callback_group=group)
        self.create_timer(0.1, self.bob, callback_group=group)
        self.create_timer(0.1, self.eve, callback_group=group)

    def ann(self):
        self.eat(0, 1)

    def bob(self):
        self.eat(1, 2)

    def eve(self):
        self.eat(2, 0)

    def eat(self, left, right):
        with self.forks[left]:
            with self.forks[right]:
                self.get_logger().info("eats")


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Table())
    executor.spin()


if __name__ == "__main__":
    main()
