import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.client = self.create_client(Trigger, "/add")
        self.create_service(Trigger, "/add", self.add)
        self.create_timer(1.0, self.tick)

    def add(self, request, response):
        return response

    def tick(self):
        future = self.client.call_async(Trigger.Request())
        future.add_done_callback(lambda: self.get_logger().info("done"))


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
