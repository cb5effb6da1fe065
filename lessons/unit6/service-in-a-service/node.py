"""A service that calls another service of the same node.

Both services, the client and the belt are in the default group, and the
executor has two threads.
"""

import time

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger

BELT_PERIOD = 1.0  # seconds
WEIGH_TIME = 0.2  # seconds
FOLD_TIME = 0.2  # seconds


class Packer(Node):
    """Packs a parcel when asked to, and weighs it with its own scales."""

    def __init__(self):
        super().__init__("packer")
        self.pack_srv = self.create_service(SetBool, "/pack", self.pack)
        self.weigh_srv = self.create_service(Trigger, "/weigh", self.weigh)
        self.scales = self.create_client(Trigger, "/weigh")
        self.belt_timer = self.create_timer(BELT_PERIOD, self.belt)

    def pack(self, request, response):
        """Weigh, then fold; answer with the weight."""
        self.get_logger().info("PACK: asks for the weight")
        weight = self.scales.call(Trigger.Request())
        if request.data:
            time.sleep(FOLD_TIME)
        response.success = weight.success
        response.message = f"PACKED {weight.message}"
        self.get_logger().info(response.message)
        return response

    def weigh(self, _request, response):
        time.sleep(WEIGH_TIME)
        response.success = True
        response.message = "2 KG"
        return response

    def belt(self):
        self.get_logger().info("BELT moves on")


def main(args=None):
    rclpy.init(args=args)
    node = Packer()
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
