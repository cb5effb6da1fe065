import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.client = self.create_client(Trigger, "grip")
        self.timer = self.create_timer(0.5, self.pick)
        self.setup_timer = self.create_timer(1.0, self.setup)

    def pick(self):
        self.timer.cancel()
        self.client.wait_for_service()
        self.client.call_async(Trigger.Request())

    def setup(self):
        self.setup_timer.cancel()
        self.create_service(Trigger, "grip", self.on_grip)

    def on_grip(self, request, response):
        return response


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
