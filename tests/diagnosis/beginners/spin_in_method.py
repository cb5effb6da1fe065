import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


class Planner(Node):
    def __init__(self):
        super().__init__("planner")
        self.client = self.create_client(Trigger, "get_map")
        self.create_service(Trigger, "get_map", self.get_map)
        self.create_timer(0.5, self.plan)

    def get_map(self, request, response):
        response.message = "map"
        return response

    def send_request(self):
        self.future = self.client.call_async(Trigger.Request())
        rclpy.spin_until_future_complete(self, self.future)
        return self.future.result()

    def load_map(self):
        return self.send_request().message

    def plan(self):
        if self.load_map() == "map":
            self.get_logger().info("planned")


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(Planner())
    executor.spin()


if __name__ == "__main__":
    main()
