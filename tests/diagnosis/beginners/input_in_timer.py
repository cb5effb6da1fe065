import rclpy
from rclpy.node import Node


class Asker(Node):
    def __init__(self):
        super().__init__("asker")
        self.create_timer(0.3, self.beat)
        self.create_timer(1.0, self.ask)

    def beat(self):
        self.get_logger().info("beat")

    def ask(self):
        speed = input("speed? ")
        self.get_logger().info(speed)


def main():
    rclpy.init()
    rclpy.spin(Asker())


if __name__ == "__main__":
    main()
