"""One node in two executors, each on a thread of its own.

Each callback group was to have an executor and a thread of its own, so
both executors are given the node.
"""

import threading
import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

STEP_PERIOD = 0.5  # seconds
INSPECTION = 2.0  # seconds


class Line(Node):
    """A belt that moves on, and a camera that inspects what lies on it."""

    def __init__(self):
        super().__init__("line")
        self.steps = 0
        self.moving = MutuallyExclusiveCallbackGroup()
        self.looking = MutuallyExclusiveCallbackGroup()
        self.timer = self.create_timer(
            STEP_PERIOD, self.belt_callback, callback_group=self.moving
        )
        self.srv = self.create_service(
            SetBool,
            "/inspect",
            self.inspect_callback,
            callback_group=self.looking,
        )

    def belt_callback(self):
        self.steps += 1
        self.get_logger().info(f"STEP {self.steps}")

    def inspect_callback(self, _request, response):
        """Take a long look, whether true or false was sent."""
        self.get_logger().warning("INSPECTING...")
        time.sleep(INSPECTION)
        self.get_logger().warning("INSPECTING...DONE")
        response.success = True
        response.message = f"step {self.steps}"
        return response


def spin(executor):
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()


def main(args=None):
    rclpy.init(args=args)
    line = Line()
    # One executor for each of the two groups? It is not asked for one.
    moving, looking = SingleThreadedExecutor(), SingleThreadedExecutor()
    moving.add_node(line)
    looking.add_node(line)
    beside = threading.Thread(target=spin, args=(moving,))
    beside.start()
    spin(looking)
    rclpy.try_shutdown()  # ends the other spin too
    beside.join()
    line.destroy_node()


if __name__ == "__main__":
    main()
