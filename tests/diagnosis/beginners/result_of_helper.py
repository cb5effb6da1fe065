"""A method returns the result of call_async() before the reply has come."""

import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Bell(Node):
    def __init__(self) -> None:
        super().__init__("bell")
        self.create_service(Trigger, "ring", self.ring)
        self.client = self.create_client(Trigger, "ring")
        self.create_timer(1.0, self.press)

    def ring(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.message = "ding"
        return response

    def send_request(self) -> Trigger.Response:
        self.future = self.client.call_async(Trigger.Request())
        return self.future.result()

    def press(self) -> None:
        response = self.send_request()
        self.get_logger().info(response.message)


def main() -> None:
    rclpy.init()
    rclpy.spin(Bell())


if __name__ == "__main__":
    main()
