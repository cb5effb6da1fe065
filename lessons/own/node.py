"""A node to begin with: a timer, a subscription and a service that takes its time."""

import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool


class MyNode(Node):
    """Counts, listens to /chatter, and switches something that is slow."""

    def __init__(self):
        super().__init__("my_node")
        self.count = 0
        # Without a group of its own the service would share the node's group with the timer, and stop it.
        switching = MutuallyExclusiveCallbackGroup()
        self.timer = self.create_timer(0.5, self.on_timer)
        self.subscription = self.create_subscription(String, "/chatter", self.on_chatter, 10)
        self.service = self.create_service(SetBool, "/switch", self.on_switch, callback_group=switching)

    def on_timer(self):
        self.count += 1
        self.get_logger().info(f"count {self.count}")

    def on_chatter(self, message):
        self.get_logger().info(f"heard {message.data}")

    def on_switch(self, request, response):
        time.sleep(2.0)
        response.success = True
        response.message = "on" if request.data else "off"
        return response


def main(args=None):
    rclpy.init(args=args)
    node = MyNode()
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


if __name__ == "__main__":
    main()
