"""A barrier lets go when two wait at it, and one callback ever does."""

import threading

import rclpy
from rclpy.node import Node


class Meeting(Node):
    def __init__(self):
        super().__init__("meeting")
        self.gate = threading.Barrier(2)
        self.create_timer(0.5, self.arrive)

    def arrive(self):
        self.gate.wait()


def main():
    rclpy.init()
    rclpy.spin(Meeting())


if __name__ == "__main__":
    main()
