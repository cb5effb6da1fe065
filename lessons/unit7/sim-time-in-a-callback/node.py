"""An oven on simulated time, which sleeps in a callback.

Simulated time comes as messages. The oven takes them on the thread that
runs its other callbacks, too.
"""

import threading

import rclpy
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock as ClockMessage
from std_srvs.srv import SetBool

SIM_TIME = [Parameter("use_sim_time", value=True)]
BAKING = Duration(seconds=2.0)


class World(Node):
    """Tells the simulated time on /clock, twenty times a second."""

    def __init__(self):
        super().__init__("world")
        self.pub = self.create_publisher(ClockMessage, "/clock", 10)
        self.begun = Clock().now()
        self.tick_timer = self.create_timer(0.05, self.tick_callback)

    def tick_callback(self):
        passed = Clock().now() - self.begun
        stamp = rclpy.time.Time(nanoseconds=passed.nanoseconds).to_msg()
        self.pub.publish(ClockMessage(clock=stamp))


class Oven(Node):
    """Bakes for two seconds of simulated time, and blinks meanwhile."""

    def __init__(self):
        super().__init__("oven", parameter_overrides=SIM_TIME)
        self.srv = self.create_service(SetBool, "/bake", self.bake_callback)
        self.lamp_timer = self.create_timer(0.5, self.lamp_callback)

    def lamp_callback(self):
        self.get_logger().info("BLINK")

    def bake_callback(self, _request, response):
        """Bake, whether true or false was sent."""
        self.get_logger().info("DOUGH IN")
        # Sleeps until /clock says that two seconds have passed.
        if self.get_clock().sleep_for(BAKING):  # False: Ctrl-C came
            self.get_logger().info("BREAD OUT")
        response.success = True
        return response


def spin(node, executor):
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()
        node.destroy_node()


def main(args=None):
    rclpy.init(args=args)
    # The world has a thread of its own, as in a process of its own.
    turning = threading.Thread(
        target=spin, args=(World(), SingleThreadedExecutor())
    )
    turning.start()
    spin(Oven(), SingleThreadedExecutor())
    rclpy.try_shutdown()
    turning.join()


if __name__ == "__main__":
    main()
