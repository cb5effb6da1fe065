import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Bool


class Wanderer(Node):
    def __init__(self):
        super().__init__("wanderer")
        self.bumped = False
        self.create_subscription(Bool, "bump", self.on_bump, 10)
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_timer(1.0, self.wander)

    def on_bump(self, message):
        self.bumped = message.data

    def wander(self):
        while True:
            twist = Twist()
            twist.linear.x = -0.1 if self.bumped else 0.1
            self.publisher.publish(twist)
            time.sleep(0.1)


def main():
    rclpy.init()
    rclpy.spin(Wanderer())


if __name__ == "__main__":
    main()
