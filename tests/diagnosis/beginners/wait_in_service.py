import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.client = self.create_client(SetBool, "/gripper")
        self.create_service(Trigger, "grip", self.grip)
        self.create_timer(0.1, self.heartbeat)
        self.asker = self.create_client(Trigger, "grip")
        self.create_timer(1.0, self.ask)

    def ask(self):
        self.asker.call_async(Trigger.Request())

    def heartbeat(self):
        self.get_logger().info("alive")

    def grip(self, request, response):
        while not self.client.wait_for_service(timeout_sec=1.0):
            self.get_logger().info("waiting")
        self.client.call_async(SetBool.Request(data=True))
        response.success = True
        return response


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
