"""Events of publishers and subscriptions without a callback: a program takes their state itself."""

from __future__ import annotations

from typing import Any

from sim.ros.bare_entities import BareEntity
from sim.ros.callback_groups import ReentrantCallbackGroup
from sim.ros.event_handler import (
    DeadlineMissedInfo,
    EventHandler,
    IncompatibleQoSInfo,
    IncompatibleTypeInfo,
    LivelinessChangedInfo,
    LivelinessLostInfo,
    MatchedInfo,
    MessageLostInfo,
    QoSPublisherEventType,
    QoSSubscriptionEventType,
)
from sim.ros.handle import Handle
from sim.ros.publisher import Publisher
from sim.ros.qos_timing import limit
from sim.ros.subscription import Subscription

_PUBLISHER_INFOS: dict[QoSPublisherEventType, type] = {
    QoSPublisherEventType.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED: DeadlineMissedInfo,
    QoSPublisherEventType.RCL_PUBLISHER_LIVELINESS_LOST: LivelinessLostInfo,
    QoSPublisherEventType.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS: IncompatibleQoSInfo,
    QoSPublisherEventType.RCL_PUBLISHER_INCOMPATIBLE_TYPE: IncompatibleTypeInfo,
    QoSPublisherEventType.RCL_PUBLISHER_MATCHED: MatchedInfo,
}
_SUBSCRIPTION_INFOS: dict[QoSSubscriptionEventType, type] = {
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED: DeadlineMissedInfo,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_LIVELINESS_CHANGED: LivelinessChangedInfo,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS: IncompatibleQoSInfo,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_MESSAGE_LOST: MessageLostInfo,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE: IncompatibleTypeInfo,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_MATCHED: MatchedInfo,
}


class BareEvent(BareEntity, EventHandler):
    """One kind of event of a publisher or subscription: what comes from now on, and the matches there are.

    Deadlines and leases are for handlers with a callback; where none is set, none is ever missed.

    Raises:
        NotImplementedError: the endpoint has a deadline, or a lease, that this event is about.
    """

    def __init__(self, endpoint: Publisher | Subscription, info: Any) -> None:
        node = endpoint.node
        _demand_no_limit(endpoint, info)
        with node.context.host.lock:
            super().__init__(node, endpoint.topic_name, _never_called, ReentrantCallbackGroup(), info)
            self._endpoint = endpoint
            endpoint.events.tell(self)
            if isinstance(info, MatchedInfo):
                self._count_matches(_number_of_matches(endpoint))

    def take_event(self) -> Any:
        """Take the state, whether it has changed or not; its changes count anew."""
        with self, self.node.context.host.lock:
            return self.take_info()

    def _count_matches(self, made: int) -> None:
        if made:
            self.info = MatchedInfo(made, made, made, made)
            self.changed()

    def destroy(self) -> None:
        """Count nothing any more."""
        with self.node.context.host.lock:
            if not self.destroyed:
                self.destroyed = True
                self._endpoint.events.tell_no_more(self)


class BareLivelinessEvent(BareEvent):
    """Counts the publishers of a subscription, all of which are alive as long as none has a lease."""

    def __init__(self, subscription: Subscription) -> None:
        super().__init__(subscription, LivelinessChangedInfo())
        self._watchers_of_endpoint = subscription.liveliness_watchers
        self._met_lease = False
        with self.node.context.host.lock:
            self._watchers_of_endpoint.append(self)
            for each in _publishers_of(subscription):
                self.found(each)

    def found(self, publisher: Publisher) -> None:
        """A publisher is matched."""
        self._met_lease = self._met_lease or publisher.lease is not None
        self._count(1)

    def gone(self, _publisher: Publisher) -> None:
        """A publisher that was matched is gone."""
        self._count(-1)

    def take_event(self) -> Any:
        """Take the state; NotImplementedError if a publisher has a lease that it may let end."""
        if self._met_lease:
            raise NotImplementedError("EventHandle: the liveliness of a publisher with a lease")
        return super().take_event()

    def destroy(self) -> None:
        """Count nothing any more."""
        with self.node.context.host.lock:
            if not self.destroyed:
                self._watchers_of_endpoint.remove(self)
            super().destroy()

    def _count(self, alive: int) -> None:
        self.info.alive_count += alive
        self.info.alive_count_change += alive
        self.changed()


def event_handle(
    endpoint: Handle | Subscription, event_type: QoSPublisherEventType | QoSSubscriptionEventType
) -> BareEvent:
    """Make the event of that type of a publisher or subscription, given by its handle.

    Raises:
        TypeError: the handle is of neither, or the other one has events of this type.
        NotImplementedError: as ``BareEvent`` does.
    """
    owner = endpoint.owner if isinstance(endpoint, Handle) else endpoint
    if isinstance(owner, Publisher) and isinstance(event_type, QoSPublisherEventType):
        return BareEvent(owner, _PUBLISHER_INFOS[event_type]())
    if isinstance(owner, Subscription) and isinstance(event_type, QoSSubscriptionEventType):
        if event_type == QoSSubscriptionEventType.RCL_SUBSCRIPTION_LIVELINESS_CHANGED:
            return BareLivelinessEvent(owner)
        return BareEvent(owner, _SUBSCRIPTION_INFOS[event_type]())
    raise TypeError(f"{type(owner).__name__} has no event {event_type!r}")


def _publishers_of(subscription: Subscription) -> list[Publisher]:
    publishers = subscription.node.context.network.publishers(subscription.name)
    return [each for each in publishers if subscription in each._reached]


def _number_of_matches(endpoint: Publisher | Subscription) -> int:
    if isinstance(endpoint, Publisher):
        return endpoint.get_subscription_count()
    return len(_publishers_of(endpoint))


def _demand_no_limit(endpoint: Publisher | Subscription, info: Any) -> None:
    if isinstance(info, DeadlineMissedInfo) and limit(endpoint.qos_profile.deadline) is not None:
        raise NotImplementedError("EventHandle: a deadline is told to deadline callbacks only")
    if isinstance(info, LivelinessLostInfo) and isinstance(endpoint, Publisher) and endpoint.lease:
        raise NotImplementedError("EventHandle: a lost lease is told to liveliness callbacks only")


def _never_called(_info: Any) -> None:
    """Stand in for a callback: the state is taken by the program."""
