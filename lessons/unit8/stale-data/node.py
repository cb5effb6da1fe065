"""Decide on pictures that come faster than they can be looked at.

A queue of ten lies between the camera and the node that decides. A
decision takes longer than the time between two pictures.
"""

import time

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

PICTURE_PERIOD = 0.2  # seconds from one picture to the next
LOOKING = 0.5  # seconds that it takes to look at a picture
QUEUE = 10  # pictures that can wait to be looked at


class Camera(Node):
    """Takes five pictures a second, and numbers them."""

    def __init__(self):
        super().__init__("camera")
        self.is_on = True
        self.number = 0
        self.pub = self.create_publisher(Int32, "/picture", 10)
        self.timer = self.create_timer(PICTURE_PERIOD, self.take_picture)
        self.srv = self.create_service(
            SetBool, "/camera", self.camera_callback
        )

    def take_picture(self):
        if self.is_on:
            self.number += 1
            self.pub.publish(Int32(data=self.number))

    def camera_callback(self, request, response):
        """Switch the camera on or off."""
        self.is_on = request.data
        response.success = True
        response.message = f"{self.number} pictures so far"
        return response


class Decider(Node):
    """Looks at a picture, and decides what to do about it."""

    def __init__(self):
        super().__init__("decider")
        self.sub = self.create_subscription(
            Int32, "/picture", self.decide, QUEUE
        )

    def decide(self, msg):
        time.sleep(LOOKING)  # the picture does not get younger
        self.get_logger().info(f"decided on picture {msg.data}")


def main(args=None):
    rclpy.init(args=args)
    # Two nodes have two default groups: the camera never waits.
    executor = MultiThreadedExecutor(num_threads=2)
    nodes = [Camera(), Decider()]
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
