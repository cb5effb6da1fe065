import time

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool


class Light(Node):
    def __init__(self):
        super().__init__("light")
        group = ReentrantCallbackGroup()
        self.state = False
        self.create_service(SetBool, "light", self.on_light, callback_group=group)
        self.client = self.create_client(SetBool, "light", callback_group=group)
        self.create_timer(1.0, self.toggle, callback_group=group)

    def on_light(self, request, response):
        time.sleep(1.0)
        self.state = request.data
        response.success = True
        return response

    def toggle(self):
        self.client.call(SetBool.Request(data=not self.state))


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(Light())
    executor.spin()


if __name__ == "__main__":
    main()
