"""The result of call_async() is used before the reply has come."""

import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Door(Node):
    def __init__(self) -> None:
        super().__init__("door")
        self.create_service(Trigger, "open", self.open)
        self.client = self.create_client(Trigger, "open")
        self.create_timer(1.0, self.knock)

    def open(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.message = "come in"
        return response

    def knock(self) -> None:
        self.client.wait_for_service()
        future = self.client.call_async(Trigger.Request())
        reply = future.result()
        self.get_logger().info(reply.message)


def main() -> None:
    rclpy.init()
    rclpy.spin(Door())


if __name__ == "__main__":
    main()
