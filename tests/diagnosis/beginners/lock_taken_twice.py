from threading import Lock

import rclpy
from rclpy.node import Node


class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.lock = Lock()
        self.count = 0
        self.create_timer(0.5, self.tick)

    def tick(self):
        with self.lock:
            self.count += 1
            self.report()

    def report(self):
        with self.lock:
            self.get_logger().info(f"count: {self.count}")


def main():
    rclpy.init()
    rclpy.spin(Counter())


if __name__ == "__main__":
    main()
