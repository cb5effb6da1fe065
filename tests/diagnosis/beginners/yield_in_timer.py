import rclpy
from rclpy.node import Node


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.create_timer(0.5, self.go)

    def go(self):
        self.get_logger().info("one")
        yield
        self.get_logger().info("two")


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
