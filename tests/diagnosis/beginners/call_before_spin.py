"""The constructor calls a service, and nothing spins yet."""

import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Gate(Node):
    def __init__(self) -> None:
        super().__init__("gate")
        self.create_service(Trigger, "width", self.tell_width)
        self.client = self.create_client(Trigger, "width")
        self.width = self.client.call(Trigger.Request()).message

    def tell_width(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.message = "3 m"
        return response


def main() -> None:
    rclpy.init()
    rclpy.spin(Gate())


if __name__ == "__main__":
    main()
