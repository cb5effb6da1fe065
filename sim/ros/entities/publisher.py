"""Publishers: what they send is a copy, as over a wire."""

from __future__ import annotations

from collections import deque
from types import GenericAlias
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

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
from sim.ros.exceptions import InvalidHandle
from sim.ros.handle import DESTROYED, Handle
from sim.ros.middleware.delivery import Delivery, ExpiringDelivery
from sim.ros.qos.qos import DurabilityPolicy, QoSProfile
from sim.ros.time.duration import Duration

if TYPE_CHECKING:
    from sim.ros.entities.subscription import Subscription
    from sim.ros.scheduling.callback_groups import CallbackGroup
    from sim.ros.scheduling.entity import OwnerNode

MsgType = TypeVar("MsgType")
"""For the type hints of programs, which import it from here as from rclpy."""


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
        msg_type: type[Message],
        topic: str,
        qos_profile: QoSProfile,
        event_callbacks: EventCallbacks | None = None,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self.node = node
        self.msg_type = msg_type
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
        """Watch what passes with time, as far as there are callbacks; returns who watches deadlines."""
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
        """Nanoseconds after which what was sent expires; None: never."""
        return limit(self.qos_profile.lifespan)

    @property
    def handle(self) -> Handle:
        """What keeps it alive while it is used."""
        return Handle(self)

    @property
    def logger_name(self) -> str:
        """The name of its node's logger."""
        return self.node.get_logger().name

    @property
    def event_handlers(self) -> list[EventHandler]:
        """What calls back for its events."""
        return self.events.handlers

    def publish(self, msg: Any) -> None:
        """Send a message, or the bytes of one, to whoever listens.

        Bytes that hold no such message are sent all the same, and reach only who takes them raw.

        Raises:
            TypeError: it is not a message of this publisher's type.
            InvalidHandle: the publisher was destroyed.
            RCLError: its context has ended.
        """
        self.send(msg)

    def require_usable(self) -> None:
        """Raise InvalidHandle if it was destroyed, RCLError if its context has ended."""
        if self.destroyed:
            raise InvalidHandle(DESTROYED)
        self.node.context.require_ok("Failed to publish", _CONTEXT_ENDED)

    def send(self, msg: Any) -> int:
        """Do what ``publish`` does, and return the message's id on the trace."""
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
        if isinstance(msg, self.msg_type):
            return copy_message(msg)
        if isinstance(msg, bytes):
            try:
                return from_cdr(self.msg_type, msg)
            except ValueError:
                return msg
        raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")

    def wait_for_all_acked(self, timeout: Duration = _FOR_EVER) -> bool:
        """Wait until every reliable subscription has what was sent: always so, since that takes no time."""
        return True

    def assert_liveliness(self) -> None:
        """Tell that it lives, which counts where that has to be done by topic."""
        if self.lease is not None:
            with self._host.lock:
                self.lease.say(self._host.clock.now())

    def get_subscription_count(self) -> int:
        """How many subscriptions it reaches."""
        return len(self._reached)

    def reach(self, subscription: Subscription) -> None:
        """Send to ``subscription`` from now on. With the host's lock held."""
        self._reached = (*self._reached, subscription)
        self.events.match_made()
        subscription.found(self)

    def reaches(self, subscription: Subscription) -> bool:
        """Whether it sends to ``subscription``."""
        return subscription in self._reached

    def forget(self, subscription: Subscription) -> None:
        """Send to ``subscription`` no more. With the host's lock held."""
        if self.reaches(subscription):
            self._reached = tuple(each for each in self._reached if each is not subscription)
            self.events.match_lost()

    def catch_up(self, subscription: Subscription) -> None:
        """Give a late subscription what a transient-local publisher kept, if both want that."""
        if self._kept and subscription.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL:
            now = self._host.clock.now()
            for delivery in self._kept:
                if not (isinstance(delivery, ExpiringDelivery) and delivery.expires <= now):
                    subscription.deliver(delivery)

    def of_another_type_than(self, subscription: Subscription) -> None:
        """Both sides tell that their types differ, when their executors next spin."""
        refused = f"Incompatible type on topic '{self.topic_name}', no messages will be"
        self.events.type_refused(f"{refused} sent to it.")
        subscription.events.type_refused(f"{refused} received from it.")
        self._record_mismatch(subscription, "TYPE")

    def incompatible_with(self, subscription: Subscription, policy: str) -> None:
        """Both sides tell that they do not match, when their executors next spin."""
        self.events.qos_refused(
            policy,
            f"New subscription discovered on topic '{self.topic_name}', requesting incompatible QoS. "
            f"No messages will be sent to it. Last incompatible policy: {policy}",
        )
        subscription.events.qos_refused(
            policy,
            f"New publisher discovered on topic '{self.topic_name}', offering incompatible QoS. "
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
        """Take it off the network; publishing raises from now on."""
        with self._host.lock:
            if self.destroyed:
                return
            self.destroyed = True
            self.node.context.network.leave_publisher(self)
            self.events.destroy()
            for subscription in self._reached:
                subscription.lost(self)

    def __enter__(self) -> Publisher:
        self.node.context.host.profile.require_with_blocks(self)
        return self

    def __exit__(self, *_error: object) -> None:
        self.destroy()
