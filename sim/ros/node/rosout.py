"""``/rosout``: the log lines of every node as messages.

Messages are made only for subscriptions; the latest lines are kept for late subscriptions.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from sim.interfaces import rcl_interfaces
from sim.ros.entities.event_handler import PublisherEventCallbacks
from sim.ros.entities.publisher import Publisher
from sim.ros.entities.subscription import Subscription
from sim.ros.logging.logger import Loggers, get_logger
from sim.ros.logging.record import LogRecord
from sim.ros.middleware.delivery import ExpiringDelivery
from sim.ros.middleware.process import current_process
from sim.ros.qos.qos import DurabilityPolicy, QoSProfile
from sim.ros.time.duration import Duration
from sim.ros.time.time import Time

if TYPE_CHECKING:
    from sim.ros.node.node import Node

ROSOUT_TOPIC = "/rosout"
ROSOUT_LIFESPAN = Duration(seconds=10)
qos_profile_rosout_default = QoSProfile(
    depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL, lifespan=ROSOUT_LIFESPAN
)


class RosoutPublisher(Publisher):
    """Publishes the lines of a node's logger, and of its children, as rcl_interfaces/msg/Log."""

    def __init__(self, node: Node) -> None:
        self.loggers = current_process().local(Loggers)
        self._lines: deque[LogRecord] = deque(maxlen=qos_profile_rosout_default.depth)
        silent = PublisherEventCallbacks(use_default_callbacks=False)
        super().__init__(node, rcl_interfaces.Log, ROSOUT_TOPIC, qos_profile_rosout_default, silent)
        # This class keeps lines instead of messages.
        self._kept = None

    def log(self, record: LogRecord) -> None:
        """Publish a line."""
        with self._host.lock:
            if self.destroyed or not self.node.context.ok():
                return
            self._lines.append(record)
            if self._reached:
                self.send(_message(record))

    def catch_up(self, subscription: Subscription) -> None:
        """Send the lines that have not expired to a late subscription, if it is transient local."""
        if subscription.qos_profile.durability != DurabilityPolicy.TRANSIENT_LOCAL:
            return
        epoch, now = self._host.clock.epoch, self._host.clock.now()
        for record in self._lines:
            sent = record.stamp - epoch
            expires = sent + ROSOUT_LIFESPAN.nanoseconds
            if expires > now:
                message = self._probe.message_id()
                data = _message(record)
                self._probe.published(message, self.topic_name, self.node.trace_id, data, self.qos_profile)
                shared = self._probe.keeps_messages
                subscription.deliver(ExpiringDelivery(data, message, sent, shared, 0, expires))


def offer_rosout(node: Node) -> RosoutPublisher | None:
    """Create the publisher of a node's log lines; None if it is disabled, or the logger has a publisher."""
    loggers = current_process().local(Loggers)
    if not loggers.rosout_enabled:
        return None
    name = node.get_logger().name
    if name in loggers.rosout:
        get_logger("rcl.logging_rosout").warning(
            f"Publisher already registered for node name: '{name}'. If this is due to multiple nodes with "
            f"the same name then all logs for the logger named '{name}' will go out over the existing "
            "publisher. As soon as any node with that name is destructed it will unregister the publisher, "
            "preventing any further logs for that name from being published on the rosout topic."
        )
        return None
    publisher = RosoutPublisher(node)
    loggers.rosout[name] = publisher
    return publisher


def withdraw_rosout(node: Node, publisher: RosoutPublisher | None) -> None:
    """Stop publishing the log lines of nodes of that name."""
    loggers = current_process().local(Loggers) if publisher is None else publisher.loggers
    loggers.rosout.pop(node.get_logger().name, None)
    if publisher is not None:
        publisher.destroy()


def _message(record: LogRecord) -> Any:
    return rcl_interfaces.Log(
        stamp=Time(nanoseconds=record.stamp).to_msg(),
        level=int(record.severity),
        name=record.logger,
        msg=record.text,
        file=record.call_site.file,
        function=record.call_site.function,
        line=record.call_site.line,
    )
