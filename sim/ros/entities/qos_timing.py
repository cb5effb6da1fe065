"""Qualities of service that depend on time: deadlines, leases of liveliness and lifespans.

What is due is due in the agenda of the node concerned, as a timer is; who looks late, counts then what came
to pass meanwhile. All is called with the host's lock held.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from sim.ros.entities.event_handler import (
    DeadlineMissedInfo,
    EventCallback,
    EventHandler,
    LivelinessChangedInfo,
    LivelinessLostInfo,
)
from sim.ros.middleware.delivery import Delivery, ExpiringDelivery
from sim.ros.qos.policies import LivelinessPolicy
from sim.ros.scheduling.entity import NEVER
from sim.ros.time.duration import Duration, Infinite

if TYPE_CHECKING:
    from sim.ros.entities.publisher import Publisher
    from sim.ros.entities.subscription import Subscription
    from sim.ros.qos.qos import QoSProfile
    from sim.ros.scheduling.callback_groups import CallbackGroup
    from sim.ros.scheduling.entity import OwnerNode

FOR_EVER = Infinite.nanoseconds
"""The period of a deadline that is not set."""


def limit(duration: Duration) -> int | None:
    """Nanoseconds of a duration in a profile; None for one that is not set or infinite."""
    return duration.nanoseconds if Duration() < duration < Infinite else None


class DeadlineHandler(EventHandler):
    """Counts deadlines that passed without a message, from the first message on.

    A message at the very moment of a deadline meets it.
    """

    def __init__(
        self, node: OwnerNode, topic: str, callback: EventCallback, callback_group: CallbackGroup, period: int
    ) -> None:
        super().__init__(node, topic, callback, callback_group, DeadlineMissedInfo())
        self._deadline = period
        self._began: int | None = None

    def message(self, now: int) -> None:
        """A message was sent, or came."""
        if self._began is not None and self._count(now):
            self.become_ready(now)
        self._began = now
        self.wait_until(now + self._deadline + 1)

    def count_until(self, now: int) -> None:
        """Count the deadlines that passed."""
        if self._began is not None:
            self._count(now)
            self.due = self._began + self._deadline + 1

    def _count(self, now: int) -> bool:
        assert self._began is not None
        missed = max(now - 1 - self._began, 0) // self._deadline
        self._began += missed * self._deadline
        self.info.count(missed)
        return missed > 0


class Lease:
    """How long a publisher counts as alive after it last said so.

    ``holder`` hears when it is lost, and each of ``watchers`` when it is lost or regained.
    """

    def __init__(self, duration: int, now: int) -> None:
        self.alive = True
        self.holder: LivelinessLostHandler | None = None
        self.watchers: list[LivelinessChangedHandler] = []
        self._duration = duration
        self._said = now

    @property
    def end(self) -> int | None:
        """The first moment at which it is over; None if it is over already."""
        return self._said + self._duration + 1 if self.alive else None

    def say(self, now: int) -> None:
        """The publisher says that it lives."""
        self.look(now)
        self._said = now
        if not self.alive:
            self.alive = True
            for each in self.watchers:
                each.count(alive=1, not_alive=-1)
        if self.holder is not None:
            self.holder.wait_until(self.end)
        for each in self.watchers:
            each.watch()

    def look(self, now: int) -> None:
        """Find out whether it is over."""
        end = self.end
        if end is not None and now >= end:
            self.alive = False
            if self.holder is not None:
                self.holder.lost()
            for each in self.watchers:
                each.count(alive=-1, not_alive=1)


class LivelinessLostHandler(EventHandler):
    """Counts how often its publisher did not say in time that it lives."""

    def __init__(
        self,
        node: OwnerNode,
        topic: str,
        callback: EventCallback,
        callback_group: CallbackGroup,
        lease: Lease | None,
    ) -> None:
        super().__init__(node, topic, callback, callback_group, LivelinessLostInfo())
        self._lease = lease
        if lease is not None:
            lease.holder = self
            self.wait_until(lease.end)

    def lost(self) -> None:
        """It is lost."""
        self.info.count()
        self.changed()

    def count_until(self, now: int) -> None:
        """Find out whether the lease is over."""
        if self._lease is not None:
            self._lease.look(now)
            self.due = self._lease.end or NEVER


class LivelinessWatcher(Protocol):
    """Who hears which publishers a subscription has. With the host's lock held."""

    def found(self, publisher: Publisher) -> None:
        """A publisher is matched."""

    def gone(self, publisher: Publisher) -> None:
        """A publisher that was matched is gone."""


class LivelinessChangedHandler(EventHandler):
    """Counts the publishers of a topic that are alive, and those that are not."""

    def __init__(
        self, node: OwnerNode, topic: str, callback: EventCallback, callback_group: CallbackGroup
    ) -> None:
        super().__init__(node, topic, callback, callback_group, LivelinessChangedInfo())
        self._leases: list[Lease] = []

    def found(self, publisher: Publisher) -> None:
        """A publisher is matched."""
        lease = publisher.lease
        if lease is None:
            self.count(alive=1, not_alive=0)
            return
        lease.look(self.node.context.host.clock.now())
        lease.watchers.append(self)
        self._leases.append(lease)
        self.count(alive=int(lease.alive), not_alive=int(not lease.alive))
        self.watch()

    def gone(self, publisher: Publisher) -> None:
        """A publisher that was matched is gone."""
        lease = publisher.lease
        if lease is None:
            self.count(alive=-1, not_alive=0)
            return
        lease.look(self.node.context.host.clock.now())
        lease.watchers.remove(self)
        self._leases.remove(lease)
        self.count(alive=-int(lease.alive), not_alive=-int(not lease.alive))
        self.watch()

    def count(self, *, alive: int, not_alive: int) -> None:
        """Change the number of living and of lost publishers."""
        self.info.alive_count += alive
        self.info.alive_count_change += alive
        self.info.not_alive_count += not_alive
        self.info.not_alive_count_change += not_alive
        self.changed()

    def watch(self) -> None:
        """Look when the next lease may be over."""
        self.wait_until(self._next_end())

    def count_until(self, now: int) -> None:
        """Find out which leases are over."""
        for lease in tuple(self._leases):
            lease.look(now)
        self.due = self._next_end() or NEVER

    def _next_end(self) -> int | None:
        return min((lease.end for lease in self._leases if lease.end is not None), default=None)

    def destroy(self) -> None:
        """Watch nothing any more."""
        super().destroy()
        for lease in self._leases:
            lease.watchers.remove(self)
        self._leases.clear()


class PublisherTiming:
    """What a publisher with a lifespan, a lease or a watched deadline does with each message."""

    def __init__(self, lifespan: int | None, lease: Lease | None, deadline: DeadlineHandler | None) -> None:
        self.lifespan = lifespan
        self._lease = lease
        self._deadline = deadline

    def sent(self, delivery: Delivery) -> Delivery:
        """A message is about to go; returns it as it goes."""
        now = delivery.published
        if self._lease is not None:
            self._lease.say(now)
        if self._deadline is not None:
            self._deadline.message(now)
        if self.lifespan is None:
            return delivery
        shared, number = delivery.shared, delivery.number
        return ExpiringDelivery(delivery.data, delivery.message, now, shared, number, now + self.lifespan)


def lease_of(qos_profile: QoSProfile, now: int) -> Lease | None:
    """The lease of a publisher that has to say itself that it lives; None for another."""
    duration = limit(qos_profile.liveliness_lease_duration)
    if duration is None or qos_profile.liveliness != LivelinessPolicy.MANUAL_BY_TOPIC:
        return None
    return Lease(duration, now)


def publisher_timing(
    qos_profile: QoSProfile, lease: Lease | None, deadline: DeadlineHandler | None
) -> PublisherTiming | None:
    """The timing of a publisher, None if it needs none."""
    lifespan = limit(qos_profile.lifespan)
    if lifespan is None and lease is None and deadline is None:
        return None
    return PublisherTiming(lifespan, lease, deadline)


class SubscriptionTiming:
    """Watches the deadline of a subscription, and takes messages out of its queue whose time is over."""

    def __init__(self, subscription: Subscription, deadline: DeadlineHandler | None) -> None:
        self._subscription = subscription
        self._deadline = deadline
        subscription.node.context.host.explain_waits_of(self)

    def arrived(self, now: int) -> None:
        """A message came."""
        if self._deadline is not None:
            self._deadline.message(now)

    def purge(self, now: int) -> None:
        """Lose what has expired."""
        subscription = self._subscription
        queue = subscription._queue
        expired = [each for each in queue if isinstance(each, ExpiringDelivery) and each.expires <= now]
        for each in expired:
            queue.remove(each)
            subscription._probe.dropped(subscription, len(queue), each.message)
        if expired and not queue:
            subscription.nothing_left()

    def explain_waits(self) -> int | None:
        """Lose what has expired; returns when the next message will."""
        self.purge(self._subscription._clock.now())
        ends = (each.expires for each in self._subscription._queue if isinstance(each, ExpiringDelivery))
        return min(ends, default=None)
