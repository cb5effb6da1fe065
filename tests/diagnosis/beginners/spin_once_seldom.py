"""A loop that waits after each ``spin_once()`` serves a timer of 100 Hz five times a second."""

import time

import rclpy
from rclpy.node import Node


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.create_timer(0.01, self.steer)

    def steer(self):
        self.get_logger().debug("steering")


def main():
    rclpy.init()
    controller = Controller()
    while rclpy.ok():
        rclpy.spin_once(controller, timeout_sec=0.1)
        time.sleep(0.2)


if __name__ == "__main__":
    main()
