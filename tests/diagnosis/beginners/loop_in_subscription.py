import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Bool


class Square(Node):
    def __init__(self):
        super().__init__("square")
        self.stopped = False
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Bool, "start", self.on_start, 10)
        self.create_subscription(Bool, "stop", self.on_stop, 10)
        self.starter = self.create_publisher(Bool, "start", 10)
        self.once = self.create_timer(0.5, self.begin)

    def begin(self):
        self.once.cancel()
        self.starter.publish(Bool(data=True))

    def on_start(self, message):
        while True:
            self.publisher.publish(Twist())
            time.sleep(0.1)
            if self.stopped:
                break
        self.get_logger().info("stopped")

    def on_stop(self, message):
        self.stopped = True


def main():
    rclpy.init()
    rclpy.spin(Square())


if __name__ == "__main__":
    main()
