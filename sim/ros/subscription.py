"""Subscriptions: a queue of what arrived, and a callback that gets one message at a time."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from sim.ros.entity import Entity, Taken
from sim.ros.interfaces import copy_message
from sim.ros.qos import QoSProfile
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.callback_groups import CallbackGroup
    from sim.ros.node import Node


class Delivery(NamedTuple):
    """A message on its way; ``shared`` tells that other subscriptions get the same object."""

    data: Any
    message: int
    published: int
    shared: bool


class Subscription(Entity):
    """Keeps the newest messages of a topic until its callback takes them, the oldest first."""

    kind = EntityKind.SUBSCRIPTION
    rank = 1

    def __init__(
        self,
        node: Node,
        msg_type: type,
        topic: str,
        callback: Callable[[Any], Any],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
    ) -> None:
        super().__init__(node, topic, callback_group)
        self.msg_type = msg_type
        self.callback = callback
        self.qos_profile = qos_profile
        self.depth = qos_profile.queue_length or 0
        self._probe = node.context.probe
        self._clock = node.context.host.clock
        self._queue: deque[Delivery] = deque()

    @property
    def topic(self) -> str:
        """The topic's full name."""
        return self.name

    @property
    def topic_name(self) -> str:
        """The topic's full name."""
        return self.name

    def get_publisher_count(self) -> int:
        """How many publishers of this type are on the topic."""
        network = self.node.context.host.network
        return sum(each.msg_type is self.msg_type for each in network.publishers(self.name))

    def deliver(self, delivery: Delivery) -> None:
        """A message arrived; a full queue loses its oldest. With the host's lock held."""
        queue = self._queue
        if self.depth and len(queue) >= self.depth:
            lost = queue.popleft()
            self._probe.dropped(self, len(queue), lost.message)
        queue.append(delivery)
        self._probe.ready(self, len(queue), delivery.message)
        self.become_ready(self._clock.now())

    def shown_callback(self) -> Callable[..., Any]:
        """The callback."""
        return self.callback

    def take(self, now: int) -> Taken | None:
        """Take the oldest message."""
        if not self._queue:
            return None
        delivery = self._queue.popleft()
        if self._queue:
            self.ready_since = now
        else:
            self.nothing_left()
        data = copy_message(delivery.data) if delivery.shared else delivery.data
        return Taken(data, delivery.message, now - delivery.published, len(self._queue))

    def invoke(self, taken: Taken) -> Any:
        """Run the callback on the message."""
        return self.callback(taken.data)

    def destroy(self) -> None:
        """Take it off the network."""
        self.node.destroy_subscription(self)
