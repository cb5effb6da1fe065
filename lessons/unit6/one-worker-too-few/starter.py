"""Three arms that wait for a clamp, and three threads: yours to mend.

Two arms were well with three threads. Then the third arm came.
"""

import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

LEFT_PERIOD = 1.0  # seconds
RIGHT_PERIOD = 1.5  # seconds
MIDDLE_PERIOD = 2.0  # seconds: every sixth second all are due
CLAMP_TIME = 0.3  # seconds that the clamp needs


class Clamp(Node):
    """Holds a part on true and lets it go on false."""

    def __init__(self):
        super().__init__("clamp")
        self.srv = self.create_service(SetBool, "/clamp", self.hold)

    def hold(self, request, response):
        time.sleep(CLAMP_TIME)
        response.success = True
        response.message = "HOLDS" if request.data else "OPEN"
        return response


class Arms(Node):
    """Three arms that ask for the clamp, each at its own pace."""

    def __init__(self):
        super().__init__("arms")
        # The replies have a seat of their own, and so has each arm.
        self.reply_group = MutuallyExclusiveCallbackGroup()
        self.clamp = self.create_client(
            SetBool, "/clamp", callback_group=self.reply_group
        )
        self.left_timer = self.add_arm(LEFT_PERIOD, self.left)
        self.right_timer = self.add_arm(RIGHT_PERIOD, self.right)
        self.middle_timer = self.add_arm(MIDDLE_PERIOD, self.middle)

    def add_arm(self, period, callback):
        """Return a timer for an arm, in a group of its own."""
        group = MutuallyExclusiveCallbackGroup()
        return self.create_timer(period, callback, callback_group=group)

    def left(self):
        self.ask("LEFT")

    def right(self):
        self.ask("RIGHT")

    def middle(self):
        self.ask("MIDDLE")

    def ask(self, arm):
        """Call the clamp, and wait here for its reply."""
        self.get_logger().info(f"{arm} asks")
        reply = self.clamp.call(SetBool.Request(data=True))
        self.get_logger().info(f"{arm} is served: {reply.message}")


def main(args=None):
    rclpy.init(args=args)
    nodes = [Clamp(), Arms()]
    # How many may wait at once, and who else needs a thread?
    executor = MultiThreadedExecutor(num_threads=3)
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
