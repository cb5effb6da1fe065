import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class Switch(Node):
    def __init__(self):
        super().__init__("switch")
        self.create_service(SetBool, "/motor_power", self.power)
        self.client = self.create_client(SetBool, "/motor_pwr")
        self.create_timer(0.5, self.tick)

    def power(self, request, response):
        return response

    def tick(self):
        while not self.client.wait_for_service(timeout_sec=0.5):
            self.get_logger().info("not there")
        self.client.call_async(SetBool.Request(data=True))


def main():
    rclpy.init()
    rclpy.spin(Switch())


if __name__ == "__main__":
    main()
