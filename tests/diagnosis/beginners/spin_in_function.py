import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


def ask(node, client, request):
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future)
    return future.result()


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
        reply = ask(self, self.client, SetBool.Request(data=True))
        self.get_logger().info(f"gripper: {reply.success}")


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
