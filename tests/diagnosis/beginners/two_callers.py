"""Two timers call services of their own group, so that a cure of one call leaves the other."""

import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Asker(Node):
    def __init__(self):
        super().__init__("asker")
        self.create_service(Trigger, "left", self.serve)
        self.create_service(Trigger, "right", self.serve)
        self.left = self.create_client(Trigger, "left")
        self.right = self.create_client(Trigger, "right")
        self.create_timer(0.5, self.ask_left)
        self.create_timer(0.7, self.ask_right)

    def serve(self, request, response):
        response.success = True
        return response

    def ask_left(self):
        reply = self.left.call(Trigger.Request())
        self.get_logger().info(f"left {reply.success}")

    def ask_right(self):
        reply = self.right.call(Trigger.Request())
        self.get_logger().info(f"right {reply.success}")


def main():
    rclpy.init()
    rclpy.spin(Asker())


if __name__ == "__main__":
    main()
