"""QoS policies that depend on time: deadlines, liveliness leases and lifespans.

A handler has its due time in its node's agenda, as a timer has. A handler that runs late counts all events up
to then. Use everything here with the host's lock held.
"""

from __future__ import annotations

from dataclasses import dataclass
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
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import NEVER, OwnerNode
from sim.ros.time.duration import Duration, Infinite

if TYPE_CHECKING:
    from sim.ros.entities.publisher import Publisher
    from sim.ros.entities.subscription import Subscription

FOR_EVER = Infinite.nanoseconds
"""The period if no deadline is set."""


def limit(duration: Duration) -> int | None:
    """The nanoseconds of a duration in a profile; None if it is not set, or infinite."""
    return duration.nanoseconds if Duration() < duration < Infinite else None


class DeadlineHandler(EventHandler):
    """Counts the deadlines that passed without a message, from the first message on.

    A message at the exact time of a deadline meets it.
    """

    def __init__(
        self, node: OwnerNode, topic: str, callback: EventCallback, callback_group: CallbackGroup, period: int
    ) -> None:
        super().__init__(node, topic, callback, callback_group, DeadlineMissedInfo())
        self._deadline = period
        self._began: int | None = None

    def message(self, now: int) -> None:
        """A message was sent or received."""
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
    """The liveliness lease of a publisher: it counts as alive for a duration after each renewal.

    ``holder`` is notified when the lease ends, ``watchers`` when it ends or is regained.
    """

    def __init__(self, duration: int, now: int) -> None:
        self.alive = True
        self.holder: LivelinessLostHandler | None = None
        self.watchers: list[LivelinessChangedHandler] = []
        self._duration = duration
        self._renewed_at = now

    @property
    def end(self) -> int | None:
        """The first time at which the lease is over; None if it is over already."""
        return self._renewed_at + self._duration + 1 if self.alive else None

    def renew(self, now: int) -> None:
        """Renew the lease: the publisher asserts its liveliness."""
        self.check(now)
        self._renewed_at = now
        if not self.alive:
            self.alive = True
            for each in self.watchers:
                each.count(alive=1, not_alive=-1)
        if self.holder is not None:
            self.holder.wait_until(self.end)
        for each in self.watchers:
            each.watch()

    def check(self, now: int) -> None:
        """Check whether the lease is over."""
        end = self.end
        if end is not None and now >= end:
            self.alive = False
            if self.holder is not None:
                self.holder.lost()
            for each in self.watchers:
                each.count(alive=-1, not_alive=1)


class LivelinessLostHandler(EventHandler):
    """Counts how often the publisher did not renew its lease in time."""

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
        """Count a lost lease."""
        self.info.count()
        self.changed()

    def count_until(self, now: int) -> None:
        """Check whether the lease is over."""
        if self._lease is not None:
            self._lease.check(now)
            self.due = self._lease.end or NEVER


class LivelinessWatcher(Protocol):
    """Is notified of the publishers of a subscription. Called with the host's lock held."""

    def publisher_matched(self, publisher: Publisher) -> None:
        """A publisher was matched."""

    def publisher_lost(self, publisher: Publisher) -> None:
        """A matched publisher is gone."""


class LivelinessChangedHandler(EventHandler):
    """Counts the publishers of a topic that are alive and not alive."""

    def __init__(
        self, node: OwnerNode, topic: str, callback: EventCallback, callback_group: CallbackGroup
    ) -> None:
        super().__init__(node, topic, callback, callback_group, LivelinessChangedInfo())
        self._leases: list[Lease] = []

    def publisher_matched(self, publisher: Publisher) -> None:
        """A publisher was matched."""
        lease = publisher.lease
        if lease is None:
            self.count(alive=1, not_alive=0)
            return
        lease.check(self.node.context.host.clock.now())
        lease.watchers.append(self)
        self._leases.append(lease)
        self.count(alive=int(lease.alive), not_alive=int(not lease.alive))
        self.watch()

    def publisher_lost(self, publisher: Publisher) -> None:
        """A matched publisher is gone."""
        lease = publisher.lease
        if lease is None:
            self.count(alive=-1, not_alive=0)
            return
        lease.check(self.node.context.host.clock.now())
        lease.watchers.remove(self)
        self._leases.remove(lease)
        self.count(alive=-int(lease.alive), not_alive=-int(not lease.alive))
        self.watch()

    def count(self, *, alive: int, not_alive: int) -> None:
        """Change the numbers of publishers that are alive and not alive."""
        self.info.alive_count += alive
        self.info.alive_count_change += alive
        self.info.not_alive_count += not_alive
        self.info.not_alive_count_change += not_alive
        self.changed()

    def watch(self) -> None:
        """Become due when the next lease may be over."""
        self.wait_until(self._next_end())

    def count_until(self, now: int) -> None:
        """Check which leases are over."""
        for lease in tuple(self._leases):
            lease.check(now)
        self.due = self._next_end() or NEVER

    def _next_end(self) -> int | None:
        return min((lease.end for lease in self._leases if lease.end is not None), default=None)

    def destroy(self) -> None:
        """Stop watching leases, and remove the handler."""
        super().destroy()
        for lease in self._leases:
            lease.watchers.remove(self)
        self._leases.clear()


@dataclass(eq=False)
class PublisherTiming:
    """Applies a publisher's lifespan, lease and deadline to each message."""

    lifespan: int | None
    _lease: Lease | None
    _deadline: DeadlineHandler | None

    def sent(self, delivery: Delivery) -> Delivery:
        """A message is about to be sent; return it with its expiry."""
        now = delivery.published
        if self._lease is not None:
            self._lease.renew(now)
        if self._deadline is not None:
            self._deadline.message(now)
        if self.lifespan is None:
            return delivery
        shared, number = delivery.shared, delivery.number
        return ExpiringDelivery(delivery.data, delivery.message, now, shared, number, now + self.lifespan)


def lease_of(qos_profile: QoSProfile, now: int) -> Lease | None:
    """The lease of a publisher with manual liveliness by topic; None for other publishers."""
    duration = limit(qos_profile.liveliness_lease_duration)
    if duration is None or qos_profile.liveliness != LivelinessPolicy.MANUAL_BY_TOPIC:
        return None
    return Lease(duration, now)


def publisher_timing(
    qos_profile: QoSProfile, lease: Lease | None, deadline: DeadlineHandler | None
) -> PublisherTiming | None:
    """The timing of a publisher; None if it needs none."""
    lifespan = limit(qos_profile.lifespan)
    if lifespan is None and lease is None and deadline is None:
        return None
    return PublisherTiming(lifespan, lease, deadline)


class SubscriptionTiming:
    """Watches the deadline of a subscription, and drops expired messages from its queue."""

    def __init__(self, subscription: Subscription, deadline: DeadlineHandler | None) -> None:
        self._subscription = subscription
        self._deadline = deadline
        subscription.node.context.host.explain_waits_with(self.explain_waits)

    def arrived(self, now: int) -> None:
        """A message arrived."""
        if self._deadline is not None:
            self._deadline.message(now)

    def purge(self, now: int) -> None:
        """Drop expired messages."""
        subscription = self._subscription
        queue = subscription._queue
        expired = [each for each in queue if isinstance(each, ExpiringDelivery) and each.expires <= now]
        for each in expired:
            queue.remove(each)
            subscription._probe.dropped(subscription, len(queue), each.message)
        if expired and not queue:
            subscription.become_idle()

    def explain_waits(self) -> int | None:
        """Drop expired messages, and return when the next message expires."""
        self.purge(self._subscription._clock.now())
        ends = (each.expires for each in self._subscription._queue if isinstance(each, ExpiringDelivery))
        return min(ends, default=None)
