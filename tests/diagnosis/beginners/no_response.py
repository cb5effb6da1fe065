import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.create_service(SetBool, "/gripper", self.answer)
        self.client = self.create_client(SetBool, "/gripper")
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.client.call_async(SetBool.Request(data=True))

    def answer(self, request, response):
        response.success = request.data  # what was asked for


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
