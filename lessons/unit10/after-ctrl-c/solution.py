"""A tank whose valve is closed before the program ends.

rclpy leaves Ctrl-C alone, so the context lives on. And main() waits for
whoever is at work before it takes everything down.
"""

import os
import signal
import threading
import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String
from std_srvs.srv import SetBool

FILLING = 3.0  # seconds
CTRL_C = 1.5  # seconds after filling began


class Tank(Node):
    """Opens a valve, and closes it three seconds later."""

    def __init__(self):
        super().__init__("tank")
        self.valve_pub = self.create_publisher(String, "valve", 10)
        self.idle = threading.Event()
        self.idle.set()
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
        self.idle.clear()
        self.ctrl_c_timer.reset()
        self.get_logger().info("VALVE OPEN")
        self.valve_pub.publish(String(data="open"))
        time.sleep(FILLING)
        self.get_logger().info("FULL")
        self.valve_pub.publish(String(data="closed"))
        self.get_logger().info("VALVE CLOSED")
        self.idle.set()
        response.success = True
        return response

    def ctrl_c_callback(self):
        """Do what a terminal does when somebody presses Ctrl-C."""
        self.ctrl_c_timer.cancel()
        self.get_logger().warning("CTRL-C")
        os.kill(os.getpid(), signal.SIGINT)


def main(args=None):
    # Ctrl-C is a KeyboardInterrupt in this thread, and nothing more.
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    node = Tank()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        node.idle.wait(timeout=2 * FILLING)
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()
        print("MAIN HAS ENDED")


if __name__ == "__main__":
    main()
