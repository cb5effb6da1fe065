"""Events of publishers and subscriptions without a callback: the program takes their state itself."""

from typing import Any

from sim.ros.entities.event_handler import (
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
from sim.ros.entities.publisher import Publisher
from sim.ros.entities.qos_timing import limit
from sim.ros.entities.subscription import Subscription
from sim.ros.handle import Handle
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.entity import never_called
from sim.ros.scheduling.watched import BareEntity

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
    """One kind of event of a publisher or subscription: later events, and the present matches.

    Deadlines and leases are supported only with callbacks; without a limit, none is ever missed.

    Raises:
        NotImplementedError: the event reports a deadline or lease, and the endpoint has one.
    """

    def __init__(self, endpoint: Publisher | Subscription, info: Any) -> None:
        node = endpoint.node
        _demand_no_limit(endpoint, info)
        with node.context.host.lock:
            super().__init__(node, endpoint.topic_name, never_called, ReentrantCallbackGroup(), info)
            self._endpoint = endpoint
            endpoint.events.add_listener(self)
            if isinstance(info, MatchedInfo):
                self._count_matches(endpoint)
            self._alive = None
            if isinstance(info, LivelinessChangedInfo) and isinstance(endpoint, Subscription):
                self._alive = _AliveCount(self, endpoint)

    def take_event(self) -> Any:
        """Take the state, changed or not, and reset its changes.

        NotImplementedError: a publisher has a lease.
        """
        if self._alive is not None and self._alive.met_lease:
            raise NotImplementedError("EventHandle: the liveliness of a publisher with a lease")
        with self, self.node.context.host.lock:
            return self.take_info()

    def _count_matches(self, endpoint: Publisher | Subscription) -> None:
        if isinstance(endpoint, Publisher):
            made = endpoint.get_subscription_count()
        else:
            made = len(_publishers_of(endpoint))
        if made:
            self.info = MatchedInfo(made, made, made, made)
            self.changed()

    def destroy(self) -> None:
        """Stop counting."""
        with self.node.context.host.lock:
            if not self.destroyed:
                self.destroyed = True
                self._endpoint.events.remove_listener(self)
                if self._alive is not None:
                    self._alive.stop()


class _AliveCount:
    """Counts the publishers of a subscription, which are all alive as long as none has a lease."""

    def __init__(self, event: BareEvent, subscription: Subscription) -> None:
        self.met_lease = False
        self._event = event
        self._watchers = subscription.liveliness_watchers
        self._watchers.append(self)
        for each in _publishers_of(subscription):
            self.publisher_matched(each)

    def publisher_matched(self, publisher: Publisher) -> None:
        """A publisher was matched."""
        self.met_lease = self.met_lease or publisher.lease is not None
        self._count(1)

    def publisher_lost(self, publisher: Publisher) -> None:
        """A matched publisher is gone."""
        self._count(-1)

    def stop(self) -> None:
        """Stop counting."""
        self._watchers.remove(self)

    def _count(self, alive: int) -> None:
        info = self._event.info
        info.alive_count += alive
        info.alive_count_change += alive
        self._event.changed()


def event_handle(
    endpoint: Handle | Subscription, event_type: QoSPublisherEventType | QoSSubscriptionEventType
) -> BareEvent:
    """Create the event of a type for a publisher or subscription, given by its handle.

    Raises:
        TypeError: the handle is not that of an endpoint with events of this type.
        NotImplementedError: as ``BareEvent`` does.
    """
    owner = endpoint.owner if isinstance(endpoint, Handle) else endpoint
    if isinstance(owner, Publisher) and isinstance(event_type, QoSPublisherEventType):
        return BareEvent(owner, _PUBLISHER_INFOS[event_type]())
    if isinstance(owner, Subscription) and isinstance(event_type, QoSSubscriptionEventType):
        return BareEvent(owner, _SUBSCRIPTION_INFOS[event_type]())
    raise TypeError(f"{type(owner).__name__} has no event {event_type!r}")


def _publishers_of(subscription: Subscription) -> list[Any]:
    publishers = subscription.node.context.network.publishers(subscription.name)
    return [each for each in publishers if each.reaches(subscription)]


def _demand_no_limit(endpoint: Publisher | Subscription, info: Any) -> None:
    if isinstance(info, DeadlineMissedInfo) and limit(endpoint.qos_profile.deadline) is not None:
        raise NotImplementedError("EventHandle: a deadline is told to deadline callbacks only")
    if isinstance(info, LivelinessLostInfo) and isinstance(endpoint, Publisher) and endpoint.lease:
        raise NotImplementedError("EventHandle: a lost lease is told to liveliness callbacks only")
