import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.create_service(SetBool, "/gripper", self.gripper)
        self.client = self.create_client(SetBool, "/gripper")
        self.create_timer(0.5, self.tick)

    def gripper(self, request, response):
        response.success = True
        return response

    def tick(self):
        self.get_logger().info("closing the gripper")
        answer = self.client.call(SetBool.Request(data=True))
        self.get_logger().info(f"gripper: {answer.success}")


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
