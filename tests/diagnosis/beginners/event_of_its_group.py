import threading

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Empty


class Door(Node):
    def __init__(self):
        super().__init__("door")
        self.opened = threading.Event()
        self.bell = self.create_publisher(Empty, "/bell", 10)
        self.create_subscription(Empty, "/bell", self.on_bell, 10)
        self.create_timer(0.1, self.ring, MutuallyExclusiveCallbackGroup())
        self.create_timer(1.0, self.go)

    def ring(self):
        self.bell.publish(Empty())

    def on_bell(self, message):
        self.opened.set()

    def go(self):
        self.opened.clear()
        self.opened.wait(0.8)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(3)
    executor.add_node(Door())
    executor.spin()


if __name__ == "__main__":
    main()
