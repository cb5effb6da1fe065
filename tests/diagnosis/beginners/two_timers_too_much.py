"""Two timers of 10 Hz take 70 and 80 ms a call: one thread has no time for both, and no wait is long."""

import time

import rclpy
from rclpy.node import Node


class Legs(Node):
    def __init__(self):
        super().__init__("legs")
        self.create_timer(0.1, self.left)
        self.create_timer(0.1, self.right)

    def left(self):
        time.sleep(0.07)

    def right(self):
        time.sleep(0.08)


def main():
    rclpy.init()
    rclpy.spin(Legs())


if __name__ == "__main__":
    main()
