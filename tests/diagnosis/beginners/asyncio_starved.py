import asyncio

import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Battery(Node):
    def __init__(self):
        super().__init__("battery")
        self.create_service(Trigger, "battery", self.on_ask)
        self.client = self.create_client(Trigger, "battery")
        self.create_timer(1.0, self.tick)

    def on_ask(self, request, response):
        response.success = True
        return response

    def tick(self):
        self.get_logger().info("tick")


async def ask(node):
    await node.client.call_async(Trigger.Request())


async def spin(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.1)


async def both(node):
    await asyncio.gather(spin(node), ask(node))


rclpy.init()
asyncio.run(both(Battery()))
