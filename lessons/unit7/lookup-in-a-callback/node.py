"""A crane that asks tf, in a callback, where its hook is just now.

One thread runs both nodes. The lookup waits for the next transform,
which comes as a message to the tf listener.
"""

import math

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool
from tf2_ros import (
    Buffer,
    TransformBroadcaster,
    TransformException,
    TransformListener,
)

SWING_PERIOD = 0.1  # seconds
PATIENCE = Duration(seconds=1.0)


class Hook(Node):
    """Swings, and broadcasts where it is, seen from the crane."""

    def __init__(self):
        super().__init__("hook")
        self.broadcaster = TransformBroadcaster(self)
        self.swing_timer = self.create_timer(SWING_PERIOD, self.swing_callback)
        self.step = 0

    def swing_callback(self):
        self.step += 1
        place = TransformStamped()
        place.header.stamp = self.get_clock().now().to_msg()
        place.header.frame_id = "crane"
        place.child_frame_id = "hook"
        place.transform.translation.x = math.sin(self.step / 10)
        self.broadcaster.sendTransform(place)


class Crane(Node):
    """Lowers its load where the hook is."""

    def __init__(self):
        super().__init__("crane")
        self.buffer = Buffer()
        # Two subscriptions, in a reentrant group that the listener makes.
        self.listener = TransformListener(self.buffer, self)
        self.srv = self.create_service(SetBool, "/lower", self.lower_callback)

    def lower_callback(self, _request, response):
        """Lower the load, whether true or false was sent."""
        now = self.get_clock().now()
        try:
            # Waits until a transform of now, or later, is in the buffer.
            found = self.buffer.lookup_transform(
                "crane", "hook", now, timeout=PATIENCE
            )
            place = found.transform.translation.x
            self.get_logger().info(f"LOWERED AT {place:.2f} m")
            response.success = True
        except TransformException as error:
            self.get_logger().error(f"{type(error).__name__}: {error}")
        return response


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    nodes = [Hook(), Crane()]
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
