import rclpy
from rclpy.node import Node

RATE = 50


class Lamp(Node):
    def __init__(self):
        super().__init__("lamp")
        self.turns = 0
        self.create_timer(1 // RATE, self.tick)
        self.create_timer(1.0, self.report)

    def tick(self):
        self.turns += 1

    def report(self):
        self.get_logger().debug(f"{self.turns} turns")


rclpy.init()
rclpy.spin(Lamp())
