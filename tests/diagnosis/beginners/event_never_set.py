"""A callback waits for an event that nothing sets; a group and a thread more do not help."""

import threading

import rclpy
from rclpy.node import Node


class Starter(Node):
    def __init__(self):
        super().__init__("starter")
        self.go = threading.Event()
        self.create_timer(0.5, self.start)
        self.create_timer(0.2, self.blink)

    def blink(self):
        pass

    def start(self):
        self.go.wait()
        self.get_logger().info("off")


def main():
    rclpy.init()
    rclpy.spin(Starter())


if __name__ == "__main__":
    main()
