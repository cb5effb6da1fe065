import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


class Mapper(Node):
    def __init__(self):
        super().__init__("mapper")
        group = MutuallyExclusiveCallbackGroup()
        self.client = self.create_client(Trigger, "map", callback_group=group)
        self.create_service(Trigger, "map", self.on_map, callback_group=group)
        self.create_timer(0.6, self.tick)

    def on_map(self, request, response):
        time.sleep(1.2)
        response.success = True
        return response

    def tick(self):
        future = self.client.call_async(Trigger.Request())
        end = time.time() + 0.5
        while not future.done() and time.time() < end:
            time.sleep(0.05)
        if not future.done():
            self.get_logger().warning("no map in time")


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Mapper())
    executor.spin()


if __name__ == "__main__":
    main()
