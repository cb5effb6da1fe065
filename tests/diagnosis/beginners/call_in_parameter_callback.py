import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger


class Tuner(Node):
    def __init__(self):
        super().__init__("tuner")
        self.declare_parameter("gain", 1.0)
        self.client = self.create_client(Trigger, "calibrate")
        self.create_service(Trigger, "calibrate", self.calibrate)
        self.add_on_set_parameters_callback(self.on_parameters)
        self.create_timer(1.0, self.tune)

    def on_parameters(self, parameters):
        reply = self.client.call(Trigger.Request())
        return SetParametersResult(successful=reply.success)

    def calibrate(self, request, response):
        response.success = True
        return response

    def tune(self):
        self.set_parameters([Parameter("gain", value=2.0)])


def main():
    rclpy.init()
    rclpy.spin(Tuner())


if __name__ == "__main__":
    main()
