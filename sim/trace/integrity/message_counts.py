"""Counts the messages of a trace: each is published, then delivered, dropped, or still in a queue."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field

from sim.trace.events import (
    AnyEvent,
    CallbackStarted,
    EntityAppeared,
    EntityGone,
    EntityId,
    EntityKind,
    EntityReady,
    MessageDropped,
    MessageId,
    Published,
    QosMismatched,
)


@dataclass
class _SubscriptionCounts:
    """The counts of a subscription's messages; ``queue`` has those that wait, in order of arrival."""

    name: str
    published: int = 0
    arrived: int = 0
    delivered: int = 0
    dropped: int = 0
    queue: dict[MessageId, None] = field(default_factory=dict)


class MessageCounts:
    """Takes the events of a run in order; ``faults`` are sentences on counts that do not add up."""

    def __init__(self) -> None:
        self.faults: list[str] = []
        self.messages = 0
        self._all: dict[EntityId, _SubscriptionCounts] = {}
        self._of_topic: dict[str, dict[EntityId, _SubscriptionCounts]] = defaultdict(dict)

    def take(self, events: Iterable[AnyEvent]) -> None:
        """Count the messages of the next events."""
        for event in events:
            match event:
                case Published(topic=topic):
                    self.messages += 1
                    for subscription in self._of_topic[topic].values():
                        subscription.published += 1
                case EntityReady(entity=entity) if entity in self._all:
                    self._arrive(event, self._all[entity])
                case CallbackStarted(entity=entity) if entity in self._all:
                    self._all[entity].delivered += 1
                    self._leave(event, self._all[entity])
                case MessageDropped(entity=entity) if entity in self._all:
                    self._all[entity].dropped += 1
                    self._leave(event, self._all[entity])
                case EntityAppeared(entity=entity, kind=EntityKind.SUBSCRIPTION, name=name):
                    self._all[entity] = self._of_topic[name][entity] = _SubscriptionCounts(name)
                case EntityGone(entity=entity) if entity in self._all:
                    self._of_topic[self._all[entity].name].pop(entity, None)
                case QosMismatched(entity=entity) if entity in self._all:
                    self._of_topic[self._all[entity].name].pop(entity, None)

    def finish(self) -> None:
        """Check the counts once all events have been taken."""
        for entity, each in self._all.items():
            followed = self._of_topic[each.name].get(entity) is each
            if followed and each.published != each.arrived:
                self._complain(each, f"{each.published} were published and {each.arrived} arrived")
            if each.arrived != each.delivered + each.dropped + len(each.queue):
                self._complain(
                    each,
                    f"{each.arrived} arrived, {each.delivered} were delivered, {each.dropped} dropped and "
                    f"{len(each.queue)} wait",
                )

    def _arrive(self, event: EntityReady, subscription: _SubscriptionCounts) -> None:
        subscription.arrived += 1
        if event.message in subscription.queue:
            self._complain(subscription, f"message {event.message} arrived twice")
        subscription.queue[event.message] = None
        self._compare(event, subscription)

    def _leave(self, event: CallbackStarted | MessageDropped, subscription: _SubscriptionCounts) -> None:
        if event.message not in subscription.queue:
            self._complain(subscription, f"message {event.message} left and had not arrived")
        subscription.queue.pop(event.message, None)
        self._compare(event, subscription)

    def _compare(
        self, event: EntityReady | CallbackStarted | MessageDropped, subscription: _SubscriptionCounts
    ) -> None:
        if event.depth != len(subscription.queue):
            self._complain(
                subscription, f"at {event.t} ns {event.depth} wait, and {len(subscription.queue)} by count"
            )

    def _complain(self, subscription: _SubscriptionCounts, what: str) -> None:
        if len(self.faults) < 5:
            self.faults.append(f"{subscription.name}: {what}")
