import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.latest = None
        self.create_subscription(LaserScan, "scna", self.on_scan, 10)
        self.publisher = self.create_publisher(Twist, "drive", 10)
        self.create_timer(0.1, self.drive)

    def on_scan(self, scan):
        self.latest = scan

    def drive(self):
        if self.latest is not None:
            self.publisher.publish(Twist())


def main():
    rclpy.init()
    rclpy.spin(Driver())


if __name__ == "__main__":
    main()
