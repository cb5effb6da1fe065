"""Events of publishers and subscriptions: matches made, lost or refused, deadlines missed, liveliness lost.

No message is ever lost on the way, so the event that tells of it never comes; a full queue that drops its
oldest is not meant by it, nor is a message whose lifespan is over.
"""

from __future__ import annotations

import inspect
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from enum import Enum, IntEnum
from typing import TYPE_CHECKING, Any, cast

from sim.ros.logging.logger import get_logger
from sim.ros.qos.policies import QoSPolicyKind
from sim.ros.scheduling.entity import NEVER, Entity, OwnerNode, Taken
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.scheduling.callback_groups import CallbackGroup

EventCallback = Callable[[Any], Any]


class QoSPublisherEventType(IntEnum):
    """What a publisher can tell of."""

    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED = 0
    RCL_PUBLISHER_LIVELINESS_LOST = 1
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS = 2
    RCL_PUBLISHER_INCOMPATIBLE_TYPE = 3
    RCL_PUBLISHER_MATCHED = 4


class QoSSubscriptionEventType(IntEnum):
    """What a subscription can tell of."""

    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED = 0
    RCL_SUBSCRIPTION_LIVELINESS_CHANGED = 1
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS = 2
    RCL_SUBSCRIPTION_MESSAGE_LOST = 3
    RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE = 4
    RCL_SUBSCRIPTION_MATCHED = 5


class UnsupportedEventTypeError(RuntimeError):
    """An event that what carries the messages does not know; never raised here."""

    __module__ = "rclpy.event_handler"


@dataclass(slots=True)
class CountedInfo:
    """How often something happened, and how often since the last event taken."""

    total_count: int = 0
    total_count_change: int = 0

    def count(self, times: int = 1) -> None:
        """It happened again."""
        self.total_count += times
        self.total_count_change += times


@dataclass(slots=True)
class MatchedInfo(CountedInfo):
    """How many matches there were and are; the changes count from the last event taken."""

    current_count: int = 0
    current_count_change: int = 0


class _EventPolicyKind(IntEnum):
    """Base of the kinds of policy as events name them, equal to those of ``QoSPolicyKind``."""

    __str__ = Enum.__str__
    __format__ = Enum.__format__


_KINDS = {f"RMW_QOS_POLICY_{kind.name}": kind.value for kind in QoSPolicyKind}
rmw_qos_policy_kind_t: Any = cast("Any", _EventPolicyKind)("rmw_qos_policy_kind_t", _KINDS)


@dataclass(slots=True)
class IncompatibleQoSInfo(CountedInfo):
    """How many matches failed for their quality of service, the last by which policy."""

    last_policy_kind: int = rmw_qos_policy_kind_t.RMW_QOS_POLICY_INVALID


class IncompatibleTypeInfo(CountedInfo):
    """How many matches failed for the type of their messages."""


class DeadlineMissedInfo(CountedInfo):
    """How many deadlines passed without a message."""


class LivelinessLostInfo(CountedInfo):
    """How often a publisher did not say in time that it lives."""


@dataclass(slots=True)
class LivelinessChangedInfo:
    """How many publishers of a topic are alive, and how many are not."""

    alive_count: int = 0
    not_alive_count: int = 0
    alive_count_change: int = 0
    not_alive_count_change: int = 0


class MessageLostInfo(CountedInfo):
    """How many messages were lost on the way."""


QoSRequestedDeadlineMissedInfo = QoSOfferedDeadlineMissedInfo = DeadlineMissedInfo
QoSLivelinessLostInfo = LivelinessLostInfo
QoSLivelinessChangedInfo = LivelinessChangedInfo
QoSMessageLostInfo = MessageLostInfo
QoSPublisherMatchedInfo = QoSSubscriptionMatchedInfo = MatchedInfo
QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo = IncompatibleQoSInfo


class EventHandler(Entity):
    """Calls back with the state of one kind of event once it has changed.

    Some events come because nothing happens until a moment: ``count_until`` counts them, at the
    moment that ``wait_until`` was told.
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
        """The state has changed. With the host's lock held."""
        self.become_ready(self.node.context.host.clock.now())

    def shown_callback(self) -> EventCallback:
        """The callback."""
        return self.callback

    def wait_until(self, due: int | None) -> None:
        """Look at ``due``; None: there is nothing to wait for."""
        self.due = NEVER if due is None else due
        if self.due < NEVER and not self.destroyed:
            self.node._agenda.timer_set(self)

    def count_until(self, now: int) -> None:
        """Count what came to pass until now, and set when to look next."""

    def take(self, now: int) -> Taken | None:
        """Take the state as it is now; its changes count anew."""
        pending = self.pending
        self.count_until(now)
        if not pending:
            return None
        taken = Taken(self.take_info(), 0, now - self.ready_since, 0)
        self.wait_until(self.due)
        return taken

    def take_info(self) -> Any:
        """Take the state, whether it has changed or not; its changes count anew."""
        info = replace(self.info)
        for each in fields(self.info):
            if each.name.endswith("_change"):
                setattr(self.info, each.name, 0)
        self.nothing_left()
        return info

    async def invoke(self, taken: Taken) -> None:
        """Run the callback on the state."""
        outcome = self.callback(taken.data)
        if inspect.iscoroutine(outcome):
            await outcome


class DefaultEventHandler(EventHandler):
    """Logs a warning for an event for which the program has no callback."""

    traced = False

    def __init__(self, node: OwnerNode, topic: str, callback_group: CallbackGroup, info: Any) -> None:
        super().__init__(node, topic, self._warn, callback_group, info)
        self.warning = ""

    def _warn(self, _info: Any) -> None:
        get_logger(self.logger_name).warning(self.warning)


@dataclass(kw_only=True, eq=False, repr=False)
class EventCallbacks:
    """Base of the callbacks for events; without one for it, a match that is refused is warned of,
    unless ``use_default_callbacks`` is false.
    """

    deadline: EventCallback | None = None
    liveliness: EventCallback | None = None
    incompatible_qos: EventCallback | None = None
    incompatible_type: EventCallback | None = None
    matched: EventCallback | None = None
    use_default_callbacks: bool = True


class PublisherEventCallbacks(EventCallbacks):
    """What a program wants to hear of a publisher."""


@dataclass(kw_only=True, eq=False, repr=False)
class SubscriptionEventCallbacks(EventCallbacks):
    """What a program wants to hear of a subscription; ``message_lost`` is never called, for none is lost."""

    message_lost: EventCallback | None = None


class EndpointEvents:
    """The matches of one publisher or subscription. All is called with the host's lock held."""

    def __init__(
        self, node: OwnerNode, topic: str, callback_group: CallbackGroup, callbacks: EventCallbacks | None
    ) -> None:
        wanted = EventCallbacks() if callbacks is None else callbacks
        self.handlers: list[EventHandler] = []
        self._node = node
        self._told: defaultdict[type, list[EventHandler]] = defaultdict(list)

        def handle(callback: EventCallback | None, info: Any) -> None:
            if callback is not None:
                self._add_told(EventHandler(node, topic, callback, callback_group, info))

        def handle_or_warn(callback: EventCallback | None, info: Any) -> None:
            if callback is None and wanted.use_default_callbacks:
                self._add_told(DefaultEventHandler(node, topic, callback_group, info))
            else:
                handle(callback, info)

        handle_or_warn(wanted.incompatible_qos, IncompatibleQoSInfo())
        handle_or_warn(wanted.incompatible_type, IncompatibleTypeInfo())
        handle(wanted.matched, MatchedInfo())

    def add(self, handler: EventHandler) -> None:
        """One handler more."""
        self.handlers.append(handler)
        self._node._agenda.add(handler)

    def tell(self, handler: EventHandler) -> None:
        """Tell ``handler`` too of matches made and lost, or refused, as its info says."""
        self._told[type(handler.info)].append(handler)

    def tell_no_more(self, handler: EventHandler) -> None:
        """Tell ``handler`` of nothing any more."""
        self._told[type(handler.info)].remove(handler)

    def _add_told(self, handler: EventHandler) -> None:
        self.add(handler)
        self.tell(handler)

    def match_made(self) -> None:
        """One match more."""
        for each in self._told[MatchedInfo]:
            info = each.info
            info.count()
            info.current_count += 1
            info.current_count_change += 1
            each.changed()

    def match_lost(self) -> None:
        """One match less."""
        for each in self._told[MatchedInfo]:
            info = each.info
            info.current_count -= 1
            info.current_count_change -= 1
            each.changed()

    def qos_refused(self, policy: str, warning: str) -> None:
        """No match for ``policy``; without a callback for that, the warning is given while spinning."""
        for each in self._told[IncompatibleQoSInfo]:
            each.info.last_policy_kind = rmw_qos_policy_kind_t(QoSPolicyKind[policy])
            _refused(each, warning)

    def type_refused(self, warning: str) -> None:
        """No match for the type of the messages; the warning as for ``qos_refused``."""
        for each in self._told[IncompatibleTypeInfo]:
            _refused(each, warning)

    def destroy(self) -> None:
        """Tell of nothing any more."""
        for each in self.handlers:
            each.destroy()


def _refused(handler: EventHandler, warning: str) -> None:
    handler.info.count()
    if isinstance(handler, DefaultEventHandler):
        handler.warning = warning
    handler.changed()
