"""A tank that is being filled when Ctrl-C comes.

The callback that fills it opens a valve, sleeps on a worker's thread,
and then publishes that the valve is to be closed.
"""

import os
import signal
import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool

FILLING = 3.0  # seconds
CTRL_C = 1.5  # seconds after filling began


class Tank(Node):
    """Opens a valve, and closes it three seconds later."""

    def __init__(self):
        super().__init__("tank")
        self.valve_pub = self.create_publisher(String, "valve", 10)
        self.srv = self.create_service(
            SetBool,
            "/fill",
            self.fill_callback,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.lamp_timer = self.create_timer(0.5, self.lamp_callback)
        self.ctrl_c_timer = self.create_timer(CTRL_C, self.ctrl_c_callback)
        self.ctrl_c_timer.cancel()  # until the tank is being filled

    def lamp_callback(self):
        self.get_logger().info("BLINK")

    def fill_callback(self, _request, response):
        """Fill the tank, whether true or false was sent."""
        self.ctrl_c_timer.reset()
        self.get_logger().info("VALVE OPEN")
        self.valve_pub.publish(String(data="open"))
        time.sleep(FILLING)
        self.get_logger().info("FULL")
        self.valve_pub.publish(String(data="closed"))
        self.get_logger().info("VALVE CLOSED")
        response.success = True
        return response

    def ctrl_c_callback(self):
        """Do what a terminal does when somebody presses Ctrl-C."""
        self.ctrl_c_timer.cancel()
        self.get_logger().warning("CTRL-C")
        os.kill(os.getpid(), signal.SIGINT)


def main(args=None):
    rclpy.init(args=args)
    node = Tank()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()
        print("MAIN HAS ENDED")


if __name__ == "__main__":
    main()
