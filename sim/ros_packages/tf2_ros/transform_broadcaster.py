"""``tf2_ros.transform_broadcaster``: sends transforms that are valid at their stamp."""

from typing import Any

from rclpy.qos import QoSProfile
from tf2_msgs.msg import TFMessage

__all__ = ["TransformBroadcaster"]


class TransformBroadcaster:
    """Publishes transforms on ``/tf``, with a depth of 100."""

    def __init__(self, node: Any, qos: Any = None) -> None:
        self.pub_tf = node.create_publisher(TFMessage, "/tf", QoSProfile(depth=100) if qos is None else qos)

    def sendTransform(self, transform: Any) -> None:
        """Send one ``TransformStamped`` or a list of them, as one message."""
        several = transform if hasattr(transform, "__iter__") else [transform]
        self.pub_tf.publish(TFMessage(transforms=list(several)))
