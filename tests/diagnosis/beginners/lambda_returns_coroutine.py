import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger


class Asker(Node):
    def __init__(self):
        super().__init__("asker")
        self.client = self.create_client(Trigger, "state")
        self.create_service(Trigger, "state", self.on_state)
        self.create_subscription(String, "name", lambda message: self.ask(message.data), 10)
        self.publisher = self.create_publisher(String, "name", 10)
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.publisher.publish(String(data="arm"))

    async def ask(self, name):
        response = await self.client.call_async(Trigger.Request())
        self.get_logger().info(f"{name}: {response.success}")

    def on_state(self, request, response):
        return response


def main():
    rclpy.init()
    rclpy.spin(Asker())


if __name__ == "__main__":
    main()
