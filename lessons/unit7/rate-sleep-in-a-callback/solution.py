"""A watchman who walks his round step by step, called by a timer.

No callback sleeps. A request starts the timer, each call of the timer
is one step, and the node remembers how far the watchman has come.
"""

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

BLINK_PERIOD = 0.5  # seconds
STEP_PERIOD = 0.5  # seconds
STEPS = 4  # of a round


class Watchman(Node):
    """Blinks to show that it lives, and walks a round when asked to."""

    def __init__(self):
        super().__init__("watchman")
        self.step = 0  # the last one of the round that he has done
        self.srv = self.create_service(
            SetBool, "/walk_round", self.walk_callback
        )
        self.blink_timer = self.create_timer(BLINK_PERIOD, self.blink_callback)
        self.step_timer = self.create_timer(STEP_PERIOD, self.step_callback)
        self.step_timer.cancel()  # until somebody asks for a round

    # --- The three callbacks: the executor runs these ---

    def blink_callback(self):
        self.get_logger().info("BLINK")

    def walk_callback(self, _request, response):
        """Start a round, whether true or false was sent."""
        self.step = 0
        self.step_timer.reset()
        response.success = True
        response.message = "ROUND STARTED"
        return response

    def step_callback(self):
        self.step += 1
        self.get_logger().info(f"STEP {self.step} of {STEPS}")
        if self.step == STEPS:
            self.get_logger().info("ROUND DONE")
            self.step_timer.cancel()


def main(args=None):
    rclpy.init(args=args)
    node = Watchman()
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
