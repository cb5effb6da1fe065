import functools
import threading

import rclpy
from rclpy.node import Node


def locked(method):
    @functools.wraps(method)
    def inner(self, *arguments):
        with self.lock:
            return method(self, *arguments)

    return inner


class Base(Node):
    def __init__(self, name):
        self.lock = threading.Lock()
        super().__init__(name)


class Counter(Base):
    def __init__(self):
        super().__init__("counter")
        self.value = 0
        self.create_timer(0.5, self.count)

    @locked
    def count(self):
        self.get_logger().info(f"counted {self.value}")
        self.add()

    @locked
    def add(self):
        self.value += 1


def main():
    rclpy.init()
    rclpy.spin(Counter())


if __name__ == "__main__":
    main()
