"""``tf2_ros.transform_listener``: fills a buffer from ``/tf`` and ``/tf_static``."""

from contextlib import suppress
from threading import Thread
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

__all__ = ["DEFAULT_STATIC_TF_TOPIC", "DEFAULT_TF_TOPIC", "TransformListener"]

DEFAULT_TF_TOPIC = "/tf"
DEFAULT_STATIC_TF_TOPIC = "/tf_static"
_AUTHORITY = "default_authority"


class TransformListener:
    """Two subscriptions of a node, in a reentrant group of their own, which write to a buffer.

    The node's executor runs their callbacks; with ``spin_thread``, a thread and executor of the
    listener's own do, which then serve the whole node. Without a node, the listener creates one.
    """

    def __init__(
        self,
        buffer: Any,
        node: Any,
        *,
        spin_thread: bool = False,
        qos: Any = None,
        static_qos: Any = None,
        tf_topic: str = DEFAULT_TF_TOPIC,
        tf_static_topic: str = DEFAULT_STATIC_TF_TOPIC,
        static_only: bool = False,
    ) -> None:
        self.buffer = buffer
        self.node = _own_node(self) if node is None else node
        self.group = ReentrantCallbackGroup()
        if not static_only:
            self.tf_sub = self.node.create_subscription(
                TFMessage,
                tf_topic,
                self.callback,
                QoSProfile(depth=100) if qos is None else qos,
                callback_group=self.group,
            )
        latched = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.tf_static_sub = self.node.create_subscription(
            TFMessage,
            tf_static_topic,
            self.static_callback,
            latched if static_qos is None else static_qos,
            callback_group=self.group,
        )
        if spin_thread:
            self.executor = SingleThreadedExecutor()
            self.dedicated_listener_thread = Thread(target=self._spin)
            self.dedicated_listener_thread.start()

    def unregister(self) -> None:
        """Stop listening."""
        if hasattr(self, "tf_sub"):
            self.node.destroy_subscription(self.tf_sub)
        self.node.destroy_subscription(self.tf_static_sub)

    def callback(self, data: Any) -> None:
        """Store transforms that are valid at their stamp."""
        for transform in data.transforms:
            self.buffer.set_transform(transform, _AUTHORITY)

    def static_callback(self, data: Any) -> None:
        """Store static transforms."""
        for transform in data.transforms:
            self.buffer.set_transform_static(transform, _AUTHORITY)

    def _spin(self) -> None:
        self.executor.add_node(self.node)
        with suppress(ExternalShutdownException):
            self.executor.spin()
        self.executor.remove_node(self.node)


def _own_node(listener: TransformListener) -> Any:
    """A node that only listens."""
    return Node(
        f"transform_listener_impl_{id(listener):010x}",
        enable_rosout=False,
        start_parameter_services=False,
        parameter_overrides=[Parameter("use_sim_time", value=False)],
    )
