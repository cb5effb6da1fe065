import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node


class Mission(Node):
    def __init__(self):
        super().__init__("mission")
        apart = MutuallyExclusiveCallbackGroup()
        self.server = ActionServer(self, Fibonacci, "drive", self.execute, callback_group=apart)
        self.client = ActionClient(self, Fibonacci, "drive")
        self.create_timer(1.0, self.send)

    def execute(self, goal_handle):
        goal_handle.succeed()
        return Fibonacci.Result()

    async def send(self):
        await self.client.send_goal_async(Fibonacci.Goal(order=3))


def main():
    rclpy.init()
    rclpy.spin(Mission())


if __name__ == "__main__":
    main()
