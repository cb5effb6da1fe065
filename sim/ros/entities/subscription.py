"""Subscriptions: a queue of messages, and a callback that gets one message at a time."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Any, TypeVar

from sim.interfaces import copy_message, to_cdr, type_name
from sim.ros.entities.entity_handles import SubscriptionHandle
from sim.ros.entities.event_handler import (
    EndpointEvents,
    EventHandler,
    MessageLostInfo,
    SubscriptionEventCallbacks,
)
from sim.ros.entities.message_info import MessageInfo, wants_message_info
from sim.ros.entities.qos_timing import (
    FOR_EVER,
    DeadlineHandler,
    LivelinessChangedHandler,
    LivelinessWatcher,
    SubscriptionTiming,
    limit,
)
from sim.ros.entities.type_support import message_class
from sim.ros.middleware.delivery import Delivery
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import Entity, OwnerNode, TakenData
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.entities.publisher import Publisher

MsgType = TypeVar("MsgType")
"""A type variable that programs import for their type hints."""


class Subscription(Entity):
    """Queues the newest messages of a topic for its callback, which gets the oldest first.

    ``topic`` is the topic's name as the program wrote it; ``topic_name`` is the full one. With ``raw`` the
    callback gets each message as bytes.

    Raises:
        RuntimeError: the callback does not take a message, or a message and its info.
    """

    class CallbackType(Enum):
        """The arguments of a callback."""

        MessageOnly = 0
        WithMessageInfo = 1

    kind = EntityKind.SUBSCRIPTION
    rank = 1

    def __init__(
        self,
        node: OwnerNode,
        msg_type: type,
        topic_name: str,
        callback: Callable[..., Any],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
        *,
        topic: str | None = None,
        raw: bool = False,
        event_callbacks: SubscriptionEventCallbacks | None = None,
    ) -> None:
        super().__init__(node, topic_name, callback_group)
        self.msg_type = message_class(msg_type)
        self.interface_type = type_name(self.msg_type)
        self.topic = topic_name if topic is None else topic
        self.raw = raw
        self.callback = callback
        self.qos_profile = qos_profile
        self.depth = qos_profile.queue_length or 0
        self._probe = node.context.probe
        self.made_at = self._probe.place_of_call()
        self.gid = node.context.host.new_gid()
        self._clock = node.context.host.clock
        self._queue: deque[Delivery] = deque()
        self._received = 0
        self.events = EndpointEvents(node, topic_name, callback_group, event_callbacks)
        self._deadline: DeadlineHandler | None = None
        self.liveliness_watchers: list[LivelinessWatcher] = []
        self._timing: SubscriptionTiming | None = None
        if event_callbacks is not None:
            self._watch(event_callbacks)

    def _watch(self, wanted: SubscriptionEventCallbacks) -> None:
        """Add handlers for the callbacks on deadlines, liveliness and lost messages."""
        node, topic, group = self.node, self.name, self.callback_group
        if wanted.deadline is not None:
            period = limit(self.qos_profile.deadline)
            self._deadline = DeadlineHandler(node, topic, wanted.deadline, group, period or FOR_EVER)
            self._timing = SubscriptionTiming(self, self._deadline)
            self.events.add(self._deadline)
        if wanted.liveliness is not None:
            liveliness = LivelinessChangedHandler(node, topic, wanted.liveliness, group)
            self.liveliness_watchers.append(liveliness)
            self.events.add(liveliness)
        if wanted.message_lost is not None:
            self.events.add(EventHandler(node, topic, wanted.message_lost, group, MessageLostInfo()))

    @property
    def handle(self) -> SubscriptionHandle:
        """A handle that keeps the subscription alive while it is used, and takes messages."""
        return SubscriptionHandle(self)

    @property
    def callback(self) -> Callable[..., Any]:
        """The callback: it gets each message, and its info if it takes two arguments."""
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., Any]) -> None:
        self._with_info = wants_message_info(value)
        self._callback = value

    @property
    def _callback_type(self) -> CallbackType:
        """The arguments of the callback, by rclpy's name."""
        return self.CallbackType.WithMessageInfo if self._with_info else self.CallbackType.MessageOnly

    @property
    def event_handlers(self) -> list[EventHandler]:
        """The handlers of the subscription's events."""
        return self.events.handlers

    @property
    def topic_name(self) -> str:
        """The topic's full name."""
        return self.name

    def get_publisher_count(self) -> int:
        """The number of publishers of this type on the topic."""
        network = self.node.context.network
        return sum(each.msg_type is self.msg_type for each in network.publishers(self.name))

    def deliver(self, delivery: Delivery) -> None:
        """Queue a message; a full queue drops its oldest one. Called with the host's lock held."""
        queue = self._queue
        if self.depth and len(queue) >= self.depth:
            lost = queue.popleft()
            self._probe.dropped(self, len(queue), lost.message)
        queue.append(delivery)
        if self._timing is not None:
            self._timing.arrived(self._clock.now())
        self._probe.ready(self, len(queue), delivery.message)
        self.become_ready(self._clock.now())

    def publisher_matched(self, publisher: Publisher) -> None:
        """A publisher was matched. Called with the host's lock held."""
        self.events.match_made()
        for each in self.liveliness_watchers:
            each.publisher_matched(publisher)
        if self._timing is None and publisher.lifespan is not None:
            self._timing = SubscriptionTiming(self, None)

    def publisher_lost(self, publisher: Publisher) -> None:
        """A matched publisher is gone. Called with the host's lock held."""
        self.events.match_lost()
        for each in self.liveliness_watchers:
            each.publisher_lost(publisher)

    def still_ready(self, now: int) -> bool:
        """Whether the subscription exists, and has a message that has not expired."""
        if self._timing is not None:
            self._timing.purge(now)
            return self.pending and not self.destroyed
        return not self.destroyed

    @property
    def queued(self) -> int:
        """The number of messages in the queue."""
        return len(self._queue)

    def take(self, now: int) -> TakenData | None:
        """Take the oldest message."""
        if self._timing is not None:
            self._timing.purge(now)
        if not self._queue:
            return None
        delivery = self._queue.popleft()
        if self._queue:
            self.ready_since = now
        else:
            self.become_idle()
        self._received += 1
        data: Any = delivery.data
        if isinstance(data, bytes):  # they do not encode a message
            if not self.raw:
                self._probe.dropped(self, len(self._queue), delivery.message)
                return None
        elif self.raw:
            data = to_cdr(data)
        elif delivery.shared:
            data = copy_message(data)
        if self._with_info:
            data = (data, self._info_of(delivery, now))
        return TakenData(data, delivery.message, now - delivery.published, len(self._queue))

    def _info_of(self, delivery: Delivery, now: int) -> MessageInfo:
        return MessageInfo(
            source_timestamp=self._clock.epoch + delivery.published,
            received_timestamp=self._clock.epoch + now,
            publication_sequence_number=delivery.number,
            reception_sequence_number=self._received,
        )

    def invoke(self, taken: TakenData) -> Any:
        """Call the callback with the message."""
        return self._callback(*taken.data) if self._with_info else self._callback(taken.data)

    def removed(self) -> None:
        """Leave the network: the subscription was removed from its node."""
        self.node.context.network.leave_subscription(self)
        self.events.destroy()
