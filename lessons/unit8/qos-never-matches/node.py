"""Show the temperature that a sensor publishes.

The sensor publishes best effort, and the display asks for reliable
messages. Topic and type are the same.
"""

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64
from std_srvs.srv import SetBool

# Best effort: each value is sent once, and may get lost.
SENSOR_QOS = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
STEP = 0.1  # degrees from one value to the next


class Sensor(Node):
    """Publishes a temperature twice a second."""

    def __init__(self):
        super().__init__("sensor")
        self.degrees = 20.0
        self.heating = True
        self.pub = self.create_publisher(Float64, "/temperature", SENSOR_QOS)
        self.timer = self.create_timer(0.5, self.measure)
        self.srv = self.create_service(
            SetBool, "/heating", self.heating_callback
        )

    def measure(self):
        self.degrees += STEP if self.heating else -STEP
        self.pub.publish(Float64(data=self.degrees))

    def heating_callback(self, request, response):
        """Switch the heating on or off."""
        self.heating = request.data
        response.success = True
        response.message = f"it is {self.degrees:.1f} degrees"
        return response


class Display(Node):
    """Shows the temperature that came last, once a second."""

    def __init__(self):
        super().__init__("display")
        self.degrees = None  # until the first value comes
        # A bare number is a queue's depth, and asks for reliable.
        self.sub = self.create_subscription(
            Float64, "/temperature", self.temperature_callback, 10
        )
        self.timer = self.create_timer(1.0, self.show)

    def temperature_callback(self, msg):
        self.degrees = msg.data

    def show(self):
        if self.degrees is None:
            self.get_logger().info("no temperature yet")
        else:
            self.get_logger().info(f"{self.degrees:.1f} degrees")


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    nodes = [Sensor(), Display()]
    for node in nodes:
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()
        for node in nodes:
            node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
