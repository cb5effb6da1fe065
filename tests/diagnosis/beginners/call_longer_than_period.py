import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


class Scales(Node):
    def __init__(self):
        super().__init__("scales")
        self.create_service(Trigger, "/weigh", self.weigh)
        group = MutuallyExclusiveCallbackGroup()
        self.client = self.create_client(Trigger, "/weigh", callback_group=group)
        self.create_timer(0.2, self.ask, MutuallyExclusiveCallbackGroup())

    def weigh(self, request, response):
        time.sleep(0.25)
        return response

    def ask(self):
        reply = self.client.call(Trigger.Request())
        self.get_logger().info(reply.message)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(3)
    executor.add_node(Scales())
    executor.spin()


if __name__ == "__main__":
    main()
