"""Subscriptions: a queue of what arrived, and a callback that gets one message at a time."""

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
from sim.ros.middleware.delivery import Delivery
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.entity import Entity, OwnerNode, Taken
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.entities.publisher import Publisher
    from sim.ros.scheduling.callback_groups import CallbackGroup

MsgType = TypeVar("MsgType")
"""For the type hints of programs, which import it from here as from rclpy."""


class Subscription(Entity):
    """Keeps the newest messages of a topic until its callback takes them, the oldest first.

    ``topic`` is the topic's name as the program wrote it; ``topic_name`` is the full one. With ``raw`` the
    callback gets each message as bytes.

    Raises:
        RuntimeError: the callback takes neither a message, nor a message and its info.
    """

    class CallbackType(Enum):
        """What a callback takes."""

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
        self.msg_type = msg_type
        self.interface_type = type_name(msg_type)
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
        """Watch what else than matches there are callbacks for."""
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
        """What keeps it alive while it is used, and takes from it."""
        return SubscriptionHandle(self)

    @property
    def callback(self) -> Callable[..., Any]:
        """What is called with each message, and with its info if it takes two arguments."""
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., Any]) -> None:
        self._with_info = wants_message_info(value)
        self._callback = value

    @property
    def _callback_type(self) -> CallbackType:
        """What the callback takes, by the name that rclpy has for it."""
        return self.CallbackType.WithMessageInfo if self._with_info else self.CallbackType.MessageOnly

    @property
    def event_handlers(self) -> list[EventHandler]:
        """What calls back for its events."""
        return self.events.handlers

    @property
    def topic_name(self) -> str:
        """The topic's full name."""
        return self.name

    def get_publisher_count(self) -> int:
        """How many publishers of this type are on the topic."""
        network = self.node.context.network
        return sum(each.msg_type is self.msg_type for each in network.publishers(self.name))

    def deliver(self, delivery: Delivery) -> None:
        """A message arrived; a full queue loses its oldest. With the host's lock held."""
        queue = self._queue
        if self.depth and len(queue) >= self.depth:
            lost = queue.popleft()
            self._probe.dropped(self, len(queue), lost.message)
        queue.append(delivery)
        if self._timing is not None:
            self._timing.arrived(self._clock.now())
        self._probe.ready(self, len(queue), delivery.message)
        self.become_ready(self._clock.now())

    def found(self, publisher: Publisher) -> None:
        """A publisher reaches it. With the host's lock held."""
        self.events.match_made()
        for each in self.liveliness_watchers:
            each.found(publisher)
        if self._timing is None and publisher.lifespan is not None:
            self._timing = SubscriptionTiming(self, None)

    def lost(self, publisher: Publisher) -> None:
        """A publisher that reached it is gone. With the host's lock held."""
        self.events.match_lost()
        for each in self.liveliness_watchers:
            each.gone(publisher)

    def still_ready(self, now: int) -> bool:
        """Whether it is there, and its messages have not all expired."""
        if self._timing is not None:
            self._timing.purge(now)
            return self.pending and not self.destroyed
        return not self.destroyed

    def shown_callback(self) -> Callable[..., Any]:
        """The callback."""
        return self._callback

    @property
    def queued(self) -> int:
        """How much waits in its queue."""
        return len(self._queue)

    def take(self, now: int) -> Taken | None:
        """Take the oldest message."""
        if self._timing is not None:
            self._timing.purge(now)
        if not self._queue:
            return None
        delivery = self._queue.popleft()
        if self._queue:
            self.ready_since = now
        else:
            self.nothing_left()
        self._received += 1
        data: Any = delivery.data
        if isinstance(data, bytes):  # they hold no message
            if not self.raw:
                self._probe.dropped(self, len(self._queue), delivery.message)
                return None
        elif self.raw:
            data = to_cdr(data)
        elif delivery.shared:
            data = copy_message(data)
        if self._with_info:
            data = (data, self._info_of(delivery, now))
        return Taken(data, delivery.message, now - delivery.published, len(self._queue))

    def _info_of(self, delivery: Delivery, now: int) -> MessageInfo:
        return MessageInfo(
            source_timestamp=self._clock.epoch + delivery.published,
            received_timestamp=self._clock.epoch + now,
            publication_sequence_number=delivery.number,
            reception_sequence_number=self._received,
        )

    def invoke(self, taken: Taken) -> Any:
        """Run the callback on the message."""
        return self._callback(*taken.data) if self._with_info else self._callback(taken.data)

    def removed(self) -> None:
        """Its node has let it go."""
        self.node.context.network.leave_subscription(self)
        self.events.destroy()
