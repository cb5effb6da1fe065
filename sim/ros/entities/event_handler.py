"""Events of publishers and subscriptions: matches made, lost or refused, deadlines missed, liveliness lost.

The simulated network never loses a message, so the "message lost" event never occurs. It does not mean a
message that a full queue drops, or whose lifespan is over.
"""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from enum import Enum, IntEnum
from typing import Any, cast

from sim.ros.logging.logger import get_logger
from sim.ros.qos.policies import QoSPolicyKind
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import NEVER, Entity, OwnerNode, TakenData
from sim.ros.scheduling.task import makes_coroutines
from sim.trace.events import EntityKind

EventCallback = Callable[[Any], Any]


class QoSPublisherEventType(IntEnum):
    """The events of a publisher."""

    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED = 0
    RCL_PUBLISHER_LIVELINESS_LOST = 1
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS = 2
    RCL_PUBLISHER_INCOMPATIBLE_TYPE = 3
    RCL_PUBLISHER_MATCHED = 4


class QoSSubscriptionEventType(IntEnum):
    """The events of a subscription."""

    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED = 0
    RCL_SUBSCRIPTION_LIVELINESS_CHANGED = 1
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS = 2
    RCL_SUBSCRIPTION_MESSAGE_LOST = 3
    RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE = 4
    RCL_SUBSCRIPTION_MATCHED = 5


class UnsupportedEventTypeError(RuntimeError):
    """The middleware does not support an event; never raised here."""

    __module__ = "rclpy.event_handler"


@dataclass(slots=True)
class CountedInfo:
    """The number of occurrences, in total and since the last take."""

    total_count: int = 0
    total_count_change: int = 0

    def count(self, times: int = 1) -> None:
        """Count further occurrences."""
        self.total_count += times
        self.total_count_change += times


@dataclass(slots=True)
class MatchedInfo(CountedInfo):
    """The number of matches, in total and now; the changes count from the last take."""

    current_count: int = 0
    current_count_change: int = 0


class _EventPolicyKind(IntEnum):
    """Base of the policy kinds in events, whose numbers equal those of ``QoSPolicyKind``."""

    __str__ = Enum.__str__
    __format__ = Enum.__format__


_KINDS = {f"RMW_QOS_POLICY_{kind.name}": kind.value for kind in QoSPolicyKind}
rmw_qos_policy_kind_t: Any = cast("Any", _EventPolicyKind)("rmw_qos_policy_kind_t", _KINDS)


@dataclass(slots=True)
class IncompatibleQoSInfo(CountedInfo):
    """The number of matches that failed for their QoS, and the policy of the last failure."""

    last_policy_kind: int = rmw_qos_policy_kind_t.RMW_QOS_POLICY_INVALID


class IncompatibleTypeInfo(CountedInfo):
    """The number of matches that failed because of the message type."""


class DeadlineMissedInfo(CountedInfo):
    """The number of deadlines that passed without a message."""


class LivelinessLostInfo(CountedInfo):
    """How often a publisher did not assert its liveliness in time."""


@dataclass(slots=True)
class LivelinessChangedInfo:
    """The numbers of publishers of a topic that are alive and not alive."""

    alive_count: int = 0
    not_alive_count: int = 0
    alive_count_change: int = 0
    not_alive_count_change: int = 0


class MessageLostInfo(CountedInfo):
    """The number of messages that the network lost."""


QoSRequestedDeadlineMissedInfo = QoSOfferedDeadlineMissedInfo = DeadlineMissedInfo
QoSLivelinessLostInfo = LivelinessLostInfo
QoSLivelinessChangedInfo = LivelinessChangedInfo
QoSMessageLostInfo = MessageLostInfo
QoSPublisherMatchedInfo = QoSSubscriptionMatchedInfo = MatchedInfo
QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo = IncompatibleQoSInfo


class EventHandler(Entity):
    """Calls the program back when the state of one kind of event has changed.

    Some events occur because nothing happens until a time: ``count_until`` counts them at the
    time given to ``wait_until``.
    """

    kind = EntityKind.WAITABLE
    rank = -1

    def __init__(
        self, node: OwnerNode, topic: str, callback: EventCallback, callback_group: CallbackGroup, info: Any
    ) -> None:
        super().__init__(node, topic, callback_group)
        self.callback = callback
        self.info = info

    def changed(self) -> None:
        """The state has changed. Called with the host's lock held."""
        self.become_ready(self.node.context.host.clock.now())

    def wait_until(self, due: int | None) -> None:
        """Become ready at ``due`` nanoseconds; None: never."""
        self.due = NEVER if due is None else due
        if self.due < NEVER and not self.destroyed:
            self.node._agenda.timer_set(self)

    def count_until(self, now: int) -> None:
        """Count the events up to ``now``, and set when the handler is due next."""

    def take(self, now: int) -> TakenData | None:
        """Take the present state, and reset its changes."""
        pending = self.pending
        self.count_until(now)
        if not pending:
            return None
        taken = TakenData(self.take_info(), 0, now - self.ready_since, 0)
        self.wait_until(self.due)
        return taken

    def take_info(self) -> Any:
        """Take the state, changed or not, and reset its changes."""
        info = replace(self.info)
        for each in fields(self.info):
            if each.name.endswith("_change"):
                setattr(self.info, each.name, 0)
        self.become_idle()
        return info

    async def invoke(self, taken: TakenData) -> None:
        """Call the callback with the state."""
        outcome = self.callback(taken.data)
        if makes_coroutines(self.callback):
            await outcome


class DefaultEventHandler(EventHandler):
    """Logs a warning for an event without a callback of the program."""

    traced = False

    def __init__(self, node: OwnerNode, topic: str, callback_group: CallbackGroup, info: Any) -> None:
        super().__init__(node, topic, self._warn, callback_group, info)
        self.warning = ""

    def _warn(self, _info: Any) -> None:
        get_logger(self.logger_name).warning(self.warning)


@dataclass(kw_only=True, eq=False, repr=False)
class EventCallbacks:
    """The callbacks for events. Without a callback a warning is logged for a refused match,
    unless ``use_default_callbacks`` is false.
    """

    deadline: EventCallback | None = None
    liveliness: EventCallback | None = None
    incompatible_qos: EventCallback | None = None
    incompatible_type: EventCallback | None = None
    matched: EventCallback | None = None
    use_default_callbacks: bool = True


class PublisherEventCallbacks(EventCallbacks):
    """The callbacks for events of a publisher."""


@dataclass(kw_only=True, eq=False, repr=False)
class SubscriptionEventCallbacks(EventCallbacks):
    """The callbacks for events of a subscription; ``message_lost`` is never called."""

    message_lost: EventCallback | None = None


class EndpointEvents:
    """The event handlers of one publisher or subscription. Use it with the host's lock held."""

    def __init__(
        self, node: OwnerNode, topic: str, callback_group: CallbackGroup, callbacks: EventCallbacks | None
    ) -> None:
        wanted = EventCallbacks() if callbacks is None else callbacks
        self.handlers: list[EventHandler] = []
        self._node = node
        self._listeners: defaultdict[type, list[EventHandler]] = defaultdict(list)

        def handle(callback: EventCallback | None, info: Any) -> None:
            if callback is not None:
                self._add_listening(EventHandler(node, topic, callback, callback_group, info))

        def handle_or_warn(callback: EventCallback | None, info: Any) -> None:
            if callback is None and wanted.use_default_callbacks:
                self._add_listening(DefaultEventHandler(node, topic, callback_group, info))
            else:
                handle(callback, info)

        handle_or_warn(wanted.incompatible_qos, IncompatibleQoSInfo())
        handle_or_warn(wanted.incompatible_type, IncompatibleTypeInfo())
        handle(wanted.matched, MatchedInfo())

    def add(self, handler: EventHandler) -> None:
        """Add a handler."""
        self.handlers.append(handler)
        self._node._agenda.add(handler)

    def add_listener(self, handler: EventHandler) -> None:
        """Report to ``handler`` the events of its info's type."""
        self._listeners[type(handler.info)].append(handler)

    def remove_listener(self, handler: EventHandler) -> None:
        """Stop reporting events to ``handler``."""
        self._listeners[type(handler.info)].remove(handler)

    def _add_listening(self, handler: EventHandler) -> None:
        self.add(handler)
        self.add_listener(handler)

    def match_made(self) -> None:
        """Count a new match."""
        for each in self._listeners[MatchedInfo]:
            info = each.info
            info.count()
            info.current_count += 1
            info.current_count_change += 1
            each.changed()

    def match_lost(self) -> None:
        """Count a lost match."""
        for each in self._listeners[MatchedInfo]:
            info = each.info
            info.current_count -= 1
            info.current_count_change -= 1
            each.changed()

    def qos_refused(self, policy: str, warning: str) -> None:
        """A match failed because of ``policy``; without a callback the warning is logged while spinning."""
        for each in self._listeners[IncompatibleQoSInfo]:
            each.info.last_policy_kind = rmw_qos_policy_kind_t(QoSPolicyKind[policy])
            _refused(each, warning)

    def type_refused(self, warning: str) -> None:
        """A match failed because of the message type; the warning is logged as for ``qos_refused``."""
        for each in self._listeners[IncompatibleTypeInfo]:
            _refused(each, warning)

    def destroy(self) -> None:
        """Remove all handlers."""
        for each in self.handlers:
            each.destroy()


def _refused(handler: EventHandler, warning: str) -> None:
    handler.info.count()
    if isinstance(handler, DefaultEventHandler):
        handler.warning = warning
    handler.changed()
