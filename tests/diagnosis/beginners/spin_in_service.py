import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from std_srvs.srv import SetBool


class Kitchen(Node):
    def __init__(self):
        super().__init__("kitchen")
        self.create_service(AddTwoInts, "/add", self.add)
        self.create_service(SetBool, "/cook", self.cook)
        self.adder = self.create_client(AddTwoInts, "/add")
        self.me = self.create_client(SetBool, "/cook")
        self.timer = self.create_timer(0.5, self.order)

    def add(self, request, response):
        response.sum = request.a + request.b
        return response

    def cook(self, request, response):
        future = self.adder.call_async(AddTwoInts.Request(a=1, b=2))
        rclpy.spin_until_future_complete(self, future)
        response.message = str(future.result().sum)
        response.success = True
        return response

    def order(self):
        self.timer.cancel()
        self.me.call_async(SetBool.Request()).add_done_callback(self.served)

    def served(self, future):
        self.get_logger().info(f"served {future.result().message}")


def main():
    rclpy.init()
    rclpy.spin(Kitchen())


if __name__ == "__main__":
    main()
