import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.publisher = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_timer(0.5, self.tick)

    def tick(self):
        command = Twist()
        command.linear.x = 1
        self.publisher.publish(command)


def main():
    rclpy.init()
    rclpy.spin(Driver())


if __name__ == "__main__":
    main()
