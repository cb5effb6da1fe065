import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.create_service(Trigger, "/gripper", self.gripper)
        self.client = self.create_client(Trigger, "/gripper")
        self.create_timer(0.5, self.tick)

    def gripper(self, request, response):
        return response

    def tick(self):
        future = self.client.call_async(Trigger.Request())
        while not future.done():
            pass
        self.get_logger().info("done")


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(Robot())
    executor.spin()


if __name__ == "__main__":
    main()
