"""Publishers: what they send is a copy, as over a wire."""

from __future__ import annotations

from collections import deque
from types import TracebackType
from typing import TYPE_CHECKING, Any

from sim.ros.exceptions import InvalidHandle
from sim.ros.interfaces import Message, copy_message
from sim.ros.qos import DurabilityPolicy, QoSProfile
from sim.ros.subscription import Delivery

if TYPE_CHECKING:
    from sim.ros.node import Node
    from sim.ros.subscription import Subscription


class Publisher:
    """Sends messages of one type to every matching subscription of a topic. Thread-safe."""

    def __init__(self, node: Node, msg_type: type[Message], topic: str, qos_profile: QoSProfile) -> None:
        self.node = node
        self.msg_type = msg_type
        self.topic = topic
        self.qos_profile = qos_profile
        self._host = node.context.host
        self._probe = node.context.probe
        self._reached: tuple[Subscription, ...] = ()
        self._kept: deque[Delivery] | None = None
        self._destroyed = False
        if qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL:
            self._kept = deque(maxlen=qos_profile.queue_length)
        with self._host.lock:
            self._host.network.join_publisher(self)

    @property
    def topic_name(self) -> str:
        """The topic's full name."""
        return self.topic

    def publish(self, msg: Any) -> None:
        """Send a message to whoever listens.

        Raises:
            TypeError: it is not a message of this publisher's type.
            InvalidHandle: the publisher was destroyed.
        """
        self.send(msg)

    def send(self, msg: Any) -> int:
        """Do what ``publish`` does, and return the message's id on the trace."""
        if not isinstance(msg, self.msg_type):
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        if self._destroyed:
            raise InvalidHandle("Cannot publish: the publisher was destroyed")
        copy = copy_message(msg)
        with self._host.lock:
            message = self._probe.message_id()
            self._probe.published(message, self.topic, self.node.trace_id)
            reached = self._reached
            shared = len(reached) > 1 or self._kept is not None
            delivery = Delivery(copy, message, self._host.clock.now(), shared)
            if self._kept is not None:
                self._kept.append(delivery)
            for subscription in reached:
                subscription.deliver(delivery)
        return message

    def get_subscription_count(self) -> int:
        """How many subscriptions it reaches."""
        return len(self._reached)

    def reach(self, subscription: Subscription) -> None:
        """Send to ``subscription`` from now on. With the host's lock held."""
        self._reached = (*self._reached, subscription)

    def forget(self, subscription: Subscription) -> None:
        """Send to ``subscription`` no more. With the host's lock held."""
        self._reached = tuple(each for each in self._reached if each is not subscription)

    def catch_up(self, subscription: Subscription) -> None:
        """Give a late subscription what a transient-local publisher kept, if both want that."""
        if self._kept and subscription.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL:
            for delivery in self._kept:
                subscription.deliver(delivery)

    def incompatible_with(self, subscription: Subscription, policy: str) -> None:
        """Both sides warn that they do not match, when their executors next spin."""
        self.node._warn_when_spinning(
            f"New subscription discovered on topic '{self.topic}', requesting incompatible QoS. "
            f"No messages will be sent to it. Last incompatible policy: {policy}"
        )
        subscription.node._warn_when_spinning(
            f"New publisher discovered on topic '{self.topic}', offering incompatible QoS. "
            f"No messages will be received from it. Last incompatible policy: {policy}"
        )

    def destroy(self) -> None:
        """Take it off the network; publishing raises from now on."""
        with self._host.lock:
            if not self._destroyed:
                self._destroyed = True
                self._host.network.leave_publisher(self)

    def __enter__(self) -> Publisher:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.destroy()
