"""``tf2_ros.static_transform_broadcaster``: sends static transforms."""

from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

__all__ = ["StaticTransformBroadcaster"]


class StaticTransformBroadcaster:
    """Publishes transforms on ``/tf_static``, where late subscriptions receive them, too."""

    def __init__(self, node: Any, qos: Any = None) -> None:
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.pub_tf = node.create_publisher(TFMessage, "/tf_static", latched if qos is None else qos)
        self.net_message = TFMessage()

    def sendTransform(self, transform: Any) -> None:
        """Send one ``TransformStamped`` or a list of them, together with all earlier ones.

        A new transform of a frame replaces the earlier one.
        """
        several = transform if hasattr(transform, "__iter__") else [transform]
        sent = {each.child_frame_id: each for each in (*self.net_message.transforms, *several)}
        self.net_message = TFMessage(transforms=list(sent.values()))
        self.pub_tf.publish(self.net_message)
