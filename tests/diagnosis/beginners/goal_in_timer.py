import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node


class Mission(Node):
    def __init__(self):
        super().__init__("mission")
        self.server = ActionServer(self, Fibonacci, "drive", self.execute)
        self.client = ActionClient(self, Fibonacci, "drive")
        self.create_timer(1.0, self.send)

    def execute(self, goal_handle):
        goal_handle.succeed()
        return Fibonacci.Result()

    def send(self):
        self.client.send_goal(Fibonacci.Goal(order=3))


def main():
    rclpy.init()
    rclpy.spin(Mission())


if __name__ == "__main__":
    main()
