import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Asker(Node):
    def __init__(self):
        super().__init__("asker")
        self.client = self.create_client(Trigger, "state")
        self.create_service(Trigger, "state", self.on_state)
        self.create_timer(0.5, self.tick)

    async def is_well(self):
        response = await self.client.call_async(Trigger.Request())
        return response.success

    def on_state(self, request, response):
        response.success = False
        return response

    def tick(self):
        if self.is_well():
            self.get_logger().info("all is well")


def main():
    rclpy.init()
    rclpy.spin(Asker())


if __name__ == "__main__":
    main()
