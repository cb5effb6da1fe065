"""Waits for one message of a topic."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sim.quantities.nanoseconds import wait_ns
from sim.ros.entities.subscription import Subscription
from sim.ros.entities.type_support import check_is_valid_msg_type
from sim.ros.middleware.delivery import Delivery
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile, as_profile
from sim.ros.scheduling.entity import never_called


class _AwaitedMessage(Subscription):
    """A subscription that no executor serves: the waiting thread takes the message."""

    traced = False

    def __init__(self, node: Node, msg_type: type, topic: str, qos_profile: QoSProfile) -> None:
        name = node.resolve_topic_name(topic)
        group = node.default_callback_group
        super().__init__(node, msg_type, name, never_called, group, qos_profile, topic=topic)
        self.handed_out = True
        self.arrived = node.context.host.clock.auto_reset_event()

    def deliver(self, delivery: Delivery) -> None:
        """Queue a message, and wake the waiting thread."""
        super().deliver(delivery)
        self.wake()

    def wake(self) -> None:
        """Wake the waiting thread."""
        self.arrived.set()


def wait_for_message(
    msg_type: type,
    node: Node,
    topic: str,
    *,
    qos_profile: QoSProfile | int = 1,
    time_to_wait: int | float = -1,
) -> tuple[bool, Any]:
    """Wait for a message: return True and the message, or False and None after ``time_to_wait`` seconds.

    The node need not be spun. A negative time waits until a message arrives or the context ends.

    Raises:
        InvalidTopicNameException: the topic's name breaks the rules.
        AttributeError, RuntimeError: ``msg_type`` is not a message class.
    """
    check_is_valid_msg_type(msg_type)
    host = node.context.host
    deadline = None if time_to_wait < 0 else host.clock.now() + wait_ns(time_to_wait)
    with host.lock:
        awaited = _AwaitedMessage(node, msg_type, topic, as_profile(qos_profile))
        node._agenda.add(awaited)
        node.context.network.join_subscription(awaited)
    node.context.wake_at_end(awaited.wake)
    try:
        awaited.arrived.wait(deadline)
        with host.lock:
            taken = awaited.take(host.clock.now())
    finally:
        awaited.destroy()
    return (False, None) if taken is None else (True, taken.data)
