"""A timer that asks a service and waits for the answer.

Two nodes share an executor with four threads. The gripper answers every
request, and the picker waits in its callback until the answer is there.
"""

import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

PICK_PERIOD = 1.0  # seconds
HEART_PERIOD = 0.5  # seconds
MOVE_TIME = 0.3  # seconds that the gripper needs


class Gripper(Node):
    """Closes on true and opens on false."""

    def __init__(self):
        super().__init__("gripper")
        self.srv = self.create_service(SetBool, "/gripper", self.move)

    def move(self, request, response):
        time.sleep(MOVE_TIME)
        response.success = True
        response.message = "CLOSED" if request.data else "OPEN"
        return response


class Picker(Node):
    """Closes and opens the gripper, one move a second."""

    def __init__(self):
        super().__init__("picker")
        self.close_next = True
        # No group is named: both go into the node's default group.
        self.gripper = self.create_client(SetBool, "/gripper")
        self.pick_timer = self.create_timer(PICK_PERIOD, self.pick)
        self.heart_group = MutuallyExclusiveCallbackGroup()
        self.heart_timer = self.create_timer(
            HEART_PERIOD, self.heartbeat, callback_group=self.heart_group
        )

    def pick(self):
        self.get_logger().info("PICK")
        # Stays in here until the reply has been taken in.
        reply = self.gripper.call(SetBool.Request(data=self.close_next))
        self.close_next = not self.close_next
        self.get_logger().info(f"GRIPPER {reply.message}")

    def heartbeat(self):
        self.get_logger().info("ALIVE")


def main(args=None):
    rclpy.init(args=args)
    nodes = [Gripper(), Picker()]
    executor = MultiThreadedExecutor(num_threads=4)
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
