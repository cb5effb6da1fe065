import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool


class Door(Node):
    def __init__(self):
        super().__init__("door")
        self.opened = threading.Event()
        self.publisher = self.create_publisher(Bool, "open", 10)
        self.create_subscription(Bool, "open", self.on_open, 10)
        self.create_timer(0.5, self.go)

    def on_open(self, message):
        self.opened.set()

    def go(self):
        self.publisher.publish(Bool(data=True))
        self.opened.wait()
        self.get_logger().info("through")


def main():
    rclpy.init()
    rclpy.spin(Door())


if __name__ == "__main__":
    main()
