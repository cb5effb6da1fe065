"""A clock that counts its ticks: yours to mend.

Ticks get lost while a lorry is unloaded, and the clock falls behind.
Change that until each line tells the right time.
"""

import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_srvs.srv import SetBool

TIMER_PERIOD = 1.0  # seconds
UNLOADING = 3.6  # seconds that a lorry takes


class ShiftClock(Node):
    """Says how long the shift has lasted, and unloads lorries."""

    def __init__(self):
        super().__init__("shift_clock")
        self.seconds = 0
        self.lorry_is_here = False
        self.srv = self.create_service(
            SetBool, "/delivery", self.delivery_callback
        )
        self.timer = self.create_timer(TIMER_PERIOD, self.timer_callback)

    def delivery_callback(self, request, response):
        """Let a lorry come (true) or send it away (false)."""
        self.lorry_is_here = request.data
        response.success = True
        response.message = "LORRY" if request.data else "NO LORRY"
        return response

    def timer_callback(self):
        # One tick more: is that one second more?
        self.seconds += 1
        self.get_logger().info(f"SHIFT LASTS {self.seconds} s")
        if self.lorry_is_here:
            self.lorry_is_here = False
            self.unload()

    def unload(self):
        self.get_logger().warning("UNLOADING...")
        time.sleep(UNLOADING)
        self.get_logger().warning("UNLOADING...DONE")


def main(args=None):
    rclpy.init(args=args)
    node = ShiftClock()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
