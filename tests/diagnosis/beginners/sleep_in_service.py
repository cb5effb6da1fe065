import time

import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.create_service(SetBool, "/gripper", self.gripper)
        self.client = self.create_client(SetBool, "/gripper")
        self.create_timer(2.0, self.close)
        self.create_timer(0.1, self.heartbeat)

    def close(self):
        self.client.call_async(SetBool.Request(data=True))

    def gripper(self, request, response):
        self.get_logger().info("closing")
        time.sleep(1.5)
        response.success = True
        return response

    def heartbeat(self):
        pass


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
