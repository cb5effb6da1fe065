"""A watchman who walks his round with Rate.sleep(): yours to mend.

He never comes to his second step, and nothing else runs any more. Have
him walk, half a second from step to step, while the blinks go on.
"""

import rclpy
from rclpy.exceptions import ROSInterruptException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

BLINK_PERIOD = 0.5  # seconds
STEPS_PER_SECOND = 2.0
STEPS = 4  # of a round


class Watchman(Node):
    """Blinks to show that it lives, and walks a round when asked to."""

    def __init__(self):
        super().__init__("watchman")
        self.srv = self.create_service(
            SetBool, "/walk_round", self.walk_callback
        )
        self.blink_timer = self.create_timer(BLINK_PERIOD, self.blink_callback)

    # --- The two callbacks: the executor runs these ---

    def blink_callback(self):
        self.get_logger().info("BLINK")

    def walk_callback(self, _request, response):
        """Walk a round, whether true or false was sent."""
        rate = self.create_rate(STEPS_PER_SECOND)
        try:
            for step in range(1, STEPS + 1):
                self.get_logger().info(f"STEP {step} of {STEPS}")
                # Who wakes it? A callback that ends needs no waking.
                rate.sleep()
            self.get_logger().info("ROUND DONE")
        except ROSInterruptException:
            pass  # Ctrl-C came while it slept
        finally:
            self.destroy_rate(rate)
        response.success = True
        response.message = "ROUND"
        return response


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
