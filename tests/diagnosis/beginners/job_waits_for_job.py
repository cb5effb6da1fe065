from concurrent.futures import ThreadPoolExecutor

import rclpy
from rclpy.node import Node


class Planner(Node):
    def __init__(self):
        super().__init__("planner")
        self.pool = ThreadPoolExecutor(max_workers=1)
        self.create_timer(0.5, self.tick)
        self.create_timer(0.5, self.blink)

    def tick(self):
        length = self.pool.submit(self.plan).result()
        self.get_logger().info(f"{length} m")

    def plan(self):
        legs = self.pool.submit(self.leg).result()
        return legs + 1

    def leg(self):
        return 1

    def blink(self):
        self.get_logger().info("blink")


def main():
    rclpy.init()
    rclpy.spin(Planner())


if __name__ == "__main__":
    main()
