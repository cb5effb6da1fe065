import rclpy
from rclpy.node import Node


class Blinker(Node):
    def __init__(self):
        super().__init__("blinker")
        self.is_on = False
        self.create_timer(1.0, self.toggle)

    def toggle(self):
        self.is_on = not self.is_on


def main():
    rclpy.init()
    blinker = Blinker()
    rate = blinker.create_rate(10)
    while rclpy.ok():
        blinker.get_logger().debug(f"on: {blinker.is_on}")
        rate.sleep()


main()
