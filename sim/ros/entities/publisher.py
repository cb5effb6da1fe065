"""Publishers; they send copies of messages, as a network does."""

from __future__ import annotations

from collections import deque
from types import GenericAlias
from typing import Any, ClassVar, TypeVar

from sim.interfaces import Message, copy_message, from_cdr
from sim.ros.entities.event_handler import EndpointEvents, EventCallbacks, EventHandler
from sim.ros.entities.qos_timing import (
    FOR_EVER,
    DeadlineHandler,
    LivelinessLostHandler,
    lease_of,
    limit,
    publisher_timing,
)
from sim.ros.entities.subscription import Subscription
from sim.ros.entities.type_support import message_class
from sim.ros.exceptions import InvalidHandle
from sim.ros.handle import DESTROYED, Handle
from sim.ros.middleware.delivery import Delivery, ExpiringDelivery
from sim.ros.qos.qos import DurabilityPolicy, QoSProfile
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import OwnerNode
from sim.ros.time.duration import Duration

MsgType = TypeVar("MsgType")
"""A type variable that programs import for their type hints."""


_FOR_EVER = Duration(seconds=-1)
_CONTEXT_ENDED = (
    "publisher's context is invalid: rclpy.shutdown() or Ctrl-C ended it; to publish after Ctrl-C, call "
    "rclpy.init(signal_handler_options=SignalHandlerOptions.NO)"
)


class Publisher:
    """Sends messages of one type to every matching subscription of a topic. Thread-safe.

    ``topic`` is the topic's name as the program wrote it; ``topic_name`` is the full one.
    """

    __class_getitem__: ClassVar[Any] = classmethod(GenericAlias)

    def __init__(
        self,
        node: OwnerNode,
        msg_type: type[Message] | Message,
        topic: str,
        qos_profile: QoSProfile,
        event_callbacks: EventCallbacks | None = None,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self.node = node
        self.msg_type: type[Message] = message_class(msg_type)
        self._given_type: Any = msg_type
        self.topic = topic
        self.topic_name = node.resolve_topic_name(topic)
        self.qos_profile = qos_profile
        self._host = node.context.host
        self._probe = node.context.probe
        self.made_at = self._probe.place_of_call()
        self.gid = self._host.new_gid()
        self._reached: tuple[Subscription, ...] = ()
        self._kept: deque[Delivery] | None = None
        self._sent = 0
        self.destroyed = False
        if qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL:
            self._kept = deque(maxlen=qos_profile.queue_length)
        with self._host.lock:
            group = node.default_callback_group if callback_group is None else callback_group
            self.events = EndpointEvents(node, self.topic_name, group, event_callbacks)
            self.lease = lease_of(qos_profile, self._host.clock.now())
            self._timing = publisher_timing(qos_profile, self.lease, self._watch(group, event_callbacks))
            self.node.context.network.join_publisher(self)

    def _watch(self, group: CallbackGroup, wanted: EventCallbacks | None) -> DeadlineHandler | None:
        """Add handlers for the callbacks on liveliness and deadlines; return the handler of deadlines."""
        if wanted is None:
            return None
        node, topic = self.node, self.topic_name
        if wanted.liveliness is not None:
            self.events.add(LivelinessLostHandler(node, topic, wanted.liveliness, group, self.lease))
        if wanted.deadline is None:
            return None
        period = limit(self.qos_profile.deadline) or FOR_EVER
        handler = DeadlineHandler(node, topic, wanted.deadline, group, period)
        self.events.add(handler)
        return handler

    @property
    def lifespan(self) -> int | None:
        """Nanoseconds after which messages expire; None: never."""
        return limit(self.qos_profile.lifespan)

    @property
    def handle(self) -> Handle:
        """A handle that keeps the publisher alive while it is used."""
        return Handle(self)

    @property
    def logger_name(self) -> str:
        """The name of the node's logger."""
        return self.node.get_logger().name

    @property
    def event_handlers(self) -> list[EventHandler]:
        """The handlers of the publisher's events."""
        return self.events.handlers

    def publish(self, msg: Any) -> None:
        """Send a message, or the bytes of a message, to all matching subscriptions.

        Bytes that do not encode such a message reach only raw subscriptions.

        Raises:
            TypeError: the message does not have the publisher's type.
            InvalidHandle: the publisher was destroyed.
            RCLError: the context has ended.
        """
        self.send(msg)

    def require_usable(self) -> None:
        """Raise InvalidHandle if the publisher was destroyed, RCLError if its context has ended."""
        if self.destroyed:
            raise InvalidHandle(DESTROYED)
        self.node.context.require_ok("Failed to publish", _CONTEXT_ENDED)

    def send(self, msg: Any) -> int:
        """Publish a message, and return its id on the trace."""
        copy = self._copy(msg)
        self.require_usable()
        with self._host.lock:
            message = self._probe.message_id()
            told = self.msg_type() if isinstance(copy, bytes) else copy
            self._probe.published(message, self.topic_name, self.node.trace_id, told, self.qos_profile)
            reached = self._reached
            shared = len(reached) > 1 or self._kept is not None or self._probe.keeps_messages
            self._sent += 1
            delivery = Delivery(copy, message, self._host.clock.now(), shared, self._sent)
            if self._timing is not None:
                delivery = self._timing.sent(delivery)
            if self._kept is not None:
                self._kept.append(delivery)
            for subscription in reached:
                subscription.deliver(delivery)
        return message

    def _copy(self, msg: Any) -> Message | bytes:
        given: type[Message] = self._given_type
        if isinstance(msg, given):  # which raises if that is a message, as in rclpy
            return copy_message(msg)
        if isinstance(msg, bytes):
            try:
                return from_cdr(self.msg_type, msg)
            except ValueError:
                return msg
        raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")

    def wait_for_all_acked(self, timeout: Duration = _FOR_EVER) -> bool:
        """True: delivery takes no time, so all subscriptions have the messages."""
        return True

    def assert_liveliness(self) -> None:
        """Renew the lease of a publisher with manual liveliness by topic."""
        if self.lease is not None:
            with self._host.lock:
                self.lease.renew(self._host.clock.now())

    def get_subscription_count(self) -> int:
        """The number of matched subscriptions."""
        return len(self._reached)

    def reach(self, subscription: Subscription) -> None:
        """Start sending to ``subscription``. Called with the host's lock held."""
        self._reached = (*self._reached, subscription)
        self.events.match_made()
        subscription.publisher_matched(self)

    def reaches(self, subscription: Subscription) -> bool:
        """Whether the publisher sends to ``subscription``."""
        return subscription in self._reached

    def forget(self, subscription: Subscription) -> None:
        """Stop sending to ``subscription``. Called with the host's lock held."""
        if self.reaches(subscription):
            self._reached = tuple(each for each in self._reached if each is not subscription)
            self.events.match_lost()

    def catch_up(self, subscription: Subscription) -> None:
        """Send the kept messages to a late subscription, if both sides are transient local."""
        if self._kept and subscription.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL:
            now = self._host.clock.now()
            for delivery in self._kept:
                if not (isinstance(delivery, ExpiringDelivery) and delivery.expires <= now):
                    subscription.deliver(delivery)

    def type_differs_from(self, subscription: Subscription) -> None:
        """Report different types on both sides, when their executors next spin."""
        refused = "Incompatible type on topic '{}', no messages will be {} it."
        self.events.type_refused(refused.format(self.topic, "sent to"))
        subscription.events.type_refused(refused.format(subscription.topic, "received from"))
        self._record_mismatch(subscription, "TYPE")

    def incompatible_with(self, subscription: Subscription, policy: str) -> None:
        """Report an incompatible policy on both sides, when their executors next spin."""
        self.events.qos_refused(
            policy,
            f"New subscription discovered on topic '{self.topic}', requesting incompatible QoS. "
            f"No messages will be sent to it. Last incompatible policy: {policy}",
        )
        subscription.events.qos_refused(
            policy,
            f"New publisher discovered on topic '{subscription.topic}', offering incompatible QoS. "
            f"No messages will be received from it. Last incompatible policy: {policy}",
        )
        self._record_mismatch(subscription, policy)

    def _record_mismatch(self, subscription: Subscription, policy: str) -> None:
        ours, theirs = self._probe, subscription.node.context.probe
        if ours.visible or theirs.visible:
            (ours if ours.visible else theirs).qos_mismatched(
                self.topic_name,
                self.node.trace_id if ours.visible else 0,
                subscription.trace_id if theirs.visible else 0,
                policy,
                (self.made_at, subscription.made_at),
            )

    def destroy(self) -> None:
        """Remove the publisher from the network; ``publish`` raises from now on."""
        with self._host.lock:
            if self.destroyed:
                return
            self.destroyed = True
            self.node.context.network.leave_publisher(self)
            self.events.destroy()
            for subscription in self._reached:
                subscription.publisher_lost(self)

    def __enter__(self) -> Publisher:
        self.node.context.host.profile.require_with_blocks(self)
        return self

    def __exit__(self, *_error: object) -> None:
        self.destroy()
