"""A belt with a speed limit.

Where more is asked for, its parameter callback sets the very parameter
that is being set, to the limit.
"""

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool

LIMIT = 4.0  # steps per second
CALM, HURRIED = 2.0, 9.0


class Belt(Node):
    """Moves at the speed that its parameter says, up to a limit."""

    def __init__(self):
        super().__init__("belt")
        self.declare_parameter("speed", CALM)
        # Asked before a parameter is stored: may it be set?
        self.add_on_set_parameters_callback(self.speed_callback)
        self.srv = self.create_service(SetBool, "/hurry", self.hurry_callback)
        self.timer = self.create_timer(0.5, self.belt_callback)

    def belt_callback(self):
        speed = self.get_parameter("speed").value
        self.get_logger().info(f"SPEED {speed}")

    def hurry_callback(self, request, response):
        """Set the speed to 9.0 (true) or 2.0 (false)."""
        speed = HURRIED if request.data else CALM
        result = self.set_parameters([Parameter("speed", value=speed)])[0]
        response.success = result.successful
        response.message = result.reason
        return response

    def speed_callback(self, parameters):
        """Keep the speed within the limit."""
        for parameter in parameters:
            if parameter.name != "speed":
                continue
            self.get_logger().info(f"ASKED FOR {parameter.value}")
            if parameter.value > LIMIT:
                self.get_logger().warning(f"TOO FAST, SO {LIMIT}")
                self.set_parameters([Parameter("speed", value=LIMIT)])
        return SetParametersResult(successful=True)


def main(args=None):
    rclpy.init(args=args)
    node = Belt()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
