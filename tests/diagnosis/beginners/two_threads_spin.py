"""Two nodes, each spun by a thread of its own: both threads spin the global executor."""

import threading

import rclpy
from rclpy.node import Node


class Wheel(Node):
    def __init__(self, name):
        super().__init__(name)
        self.create_timer(0.2, self.turn)

    def turn(self):
        self.get_logger().info("turns")


def main():
    rclpy.init()
    left, right = Wheel("left"), Wheel("right")
    first = threading.Thread(target=rclpy.spin, args=(left,))
    second = threading.Thread(target=rclpy.spin, args=(right,))
    first.start()
    second.start()
    first.join()
    second.join()


if __name__ == "__main__":
    main()
