"""Two nodes, each in an executor of its own, each on a thread of its own.

The belt moves on twice a second. An inspection takes three seconds.
"""

import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

TIMER_PERIOD = 0.5  # seconds from step to step of the belt
INSPECTION = 3.0  # seconds


class Belt(Node):
    """Moves a belt on, step by step."""

    def __init__(self):
        super().__init__("belt")
        self.steps = 0
        self.timer = self.create_timer(TIMER_PERIOD, self.belt_callback)

    def belt_callback(self):
        self.steps += 1
        self.get_logger().info(f"STEP {self.steps}")


class Inspector(Node):
    """Looks at a parcel when it is asked to, and takes its time."""

    def __init__(self):
        super().__init__("inspector")
        self.srv = self.create_service(
            SetBool, "/inspect", self.inspect_callback
        )

    def inspect_callback(self, _request, response):
        """Inspect a parcel, whether true or false was sent."""
        self.get_logger().warning("INSPECTING...")
        time.sleep(INSPECTION)
        self.get_logger().warning("INSPECTING...DONE")
        response.success = True
        response.message = "GOOD"
        return response


def spin_beside(executor):
    """Spin until the program is shut down; for a thread of its own."""
    try:
        executor.spin()
    except ExternalShutdownException:
        return  # Ctrl-C: the main thread ends the program


def main(args=None):
    rclpy.init(args=args)
    belt = Belt()
    inspector = Inspector()
    # An executor for each node, and a thread for each executor.
    belt_executor = SingleThreadedExecutor()
    belt_executor.add_node(belt)
    inspector_executor = SingleThreadedExecutor()
    inspector_executor.add_node(inspector)
    beside = threading.Thread(target=spin_beside, args=(inspector_executor,))
    beside.start()
    try:
        belt_executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        rclpy.try_shutdown()  # ends the other spin too
        beside.join()
        belt.destroy_node()
        inspector.destroy_node()


if __name__ == "__main__":
    main()
