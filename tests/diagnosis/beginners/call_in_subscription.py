import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool


class Gripper(Node):
    def __init__(self):
        super().__init__("gripper")
        self.create_service(SetBool, "/gripper", self.gripper)

    def gripper(self, request, response):
        response.success = True
        return response


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.client = self.create_client(SetBool, "/gripper")
        self.publisher = self.create_publisher(String, "order", 10)
        self.create_subscription(String, "order", self.on_order, 10)
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.publisher.publish(String(data="close"))

    def on_order(self, message):
        request = SetBool.Request()
        request.data = message.data == "close"
        response = self.client.call(request)
        self.get_logger().info(f"gripper: {response.success}")


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Gripper())
    executor.add_node(Robot())
    executor.spin()


if __name__ == "__main__":
    main()
