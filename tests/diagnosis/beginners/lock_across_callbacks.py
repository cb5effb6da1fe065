from threading import Lock

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        group = ReentrantCallbackGroup()
        self.arm = Lock()
        self.camera = Lock()
        self.create_timer(0.5, self.move, callback_group=group)
        self.create_timer(0.5, self.look, callback_group=group)
        self.create_timer(0.1, self.heartbeat, callback_group=group)

    def heartbeat(self):
        self.get_logger().info("alive")

    def move(self):
        with self.arm:
            self.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.1))
            with self.camera:
                self.get_logger().info("moved")

    def look(self):
        with self.camera:
            self.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.1))
            with self.arm:
                self.get_logger().info("looked")


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Robot())
    executor.spin()


if __name__ == "__main__":
    main()
