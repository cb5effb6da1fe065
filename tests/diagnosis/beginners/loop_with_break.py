import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, String


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.arrived = False
        self.create_subscription(Bool, "arrived", self.on_arrived, 10)
        self.publisher = self.create_publisher(String, "cmd", 10)
        self.create_timer(0.5, self.drive)

    def on_arrived(self, message):
        self.arrived = message.data

    def drive(self):
        while True:
            self.publisher.publish(String(data="go"))
            # enough?
            if self.arrived:
                break
            time.sleep(0.1)
        self.get_logger().info("arrived")


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
