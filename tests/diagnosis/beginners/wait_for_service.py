import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.client = self.create_client(SetBool, "/gripper")
        self.create_timer(0.5, self.tick)
        self.create_timer(0.1, self.heartbeat)

    def heartbeat(self):
        self.get_logger().info("alive")

    def tick(self):
        self.client.wait_for_service()
        self.client.call_async(SetBool.Request(data=True))


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
