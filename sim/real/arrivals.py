"""Reconstructs the queues of subscriptions, services and clients from what rclpy sends and takes.

rclpy does not report the content of its queues. While an entity waits, its queue is taken to hold the latest
messages of its topic that it has not taken yet. Messages arrive in the order in which a publisher sent them,
so those that do not fit into the queue, and those that the entity passes over, are lost. Messages that were
sent before the first one that it takes from a publisher were sent before discovery had connected the two.
"""

from collections import defaultdict, deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from sim.trace.events import AnyEvent, EntityAppeared, EntityKind, EntityReady, MessageDropped

_REMEMBERED = 2_000
"""The most messages kept per queue, and the most unanswered calls kept per service."""
_EARLY = 100
"""The most takes kept per queue for which no sending has been reported yet."""


class SentMessage(NamedTuple):
    """A message or request that was sent, from ``before`` to ``after`` (nanoseconds since 1970)."""

    number: int
    sender: int
    before: int
    after: int


@dataclass
class _Queue:
    entity: int
    kind: EntityKind
    depth: int
    untaken: deque[SentMessage] = field(default_factory=lambda: deque(maxlen=_REMEMBERED))
    handled: dict[int, int] = field(default_factory=dict)
    """Numbers of a service's requests that are taken and not answered yet, by the time of sending."""
    told: list[int] = field(default_factory=list)
    """Numbers of the messages that the trace says are in it."""
    waits: bool = False
    early: deque[int] = field(default_factory=lambda: deque(maxlen=_EARLY))
    """Times of sending of messages whose take was reported before their sending."""
    heard: set[int] = field(default_factory=set)
    """Senders from which something was taken: discovery has connected them."""

    def was_taken(self, sending: SentMessage) -> bool:
        """Whether a message whose sending is reported late was taken already; answers True once per take."""
        stamp = next((each for each in self.early if sending.before <= each <= sending.after), None)
        if stamp is not None:
            self.early.remove(stamp)
            self.hears(sending.sender)
        return stamp is not None

    def is_reached_by(self, sending: SentMessage) -> bool:
        """Whether a message reaches this queue, as far as is known."""
        return not self.heard or sending.sender in self.heard

    def hears(self, sender: int) -> None:
        """Note that a message of a sender was taken; until the first one all senders count as connected."""
        if not self.heard:
            others = {each.number for each in self.untaken if each.sender != sender}
            self.told = [number for number in self.told if number not in others]
        self.heard.add(sender)


class Arrivals:
    """Follows the queues of subscriptions, services and clients."""

    def __init__(self) -> None:
        self._queues: dict[int, _Queue] = {}
        self._readers: defaultdict[str, list[_Queue]] = defaultdict(list)
        self._pending: defaultdict[str, dict[int, None]] = defaultdict(dict)
        """The calls of each service whose replies were not taken yet, in the order of sending."""
        self._names: dict[int, str] = {}

    def appeared(self, entity: EntityAppeared) -> None:
        """Add an entity."""
        self._names[entity.entity] = entity.name
        queue = _Queue(entity.entity, entity.kind, max(1, entity.depth))
        self._queues[entity.entity] = queue
        if entity.kind in (EntityKind.SUBSCRIPTION, EntityKind.SERVICE):
            self._readers[entity.name].append(queue)

    def gone(self, entity: int) -> None:
        """Remove an entity."""
        queue = self._queues.pop(entity, None)
        readers = self._readers[self._names.pop(entity, "")]
        if queue in readers:
            readers.remove(queue)

    def sent(self, t: int, name: str, sending: SentMessage) -> Iterator[AnyEvent]:
        """Add a message or request to the queues of its topic or service."""
        for queue in self._readers[name]:
            if queue.was_taken(sending):
                continue
            queue.untaken.append(sending)
            if queue.waits and queue.is_reached_by(sending):
                yield from self._arrived(t, queue, sending.number)

    def called(self, service: str, call: int) -> None:
        """Add a service call."""
        pending = self._pending[service]
        pending[call] = None
        if len(pending) > _REMEMBERED:
            del pending[next(iter(pending))]

    def replied(self, entity: int, sent: int) -> tuple[str, int]:
        """Note the reply to the request sent at ``sent``; returns the service's name and the call's number.

        The number is 0 if the caller is not watched.
        """
        queue = self._queues.get(entity)
        return self._names.get(entity, ""), 0 if queue is None else queue.handled.pop(sent, 0)

    def reply_arrived(self, service: str, call: int) -> None:
        """Note that the client has taken the reply of a call."""
        self._pending[service].pop(call, None)

    def ready(self, t: int, entity: int) -> Iterator[AnyEvent]:
        """Note that an entity waits, and yield what is in its queue."""
        queue = self._queues.get(entity)
        if queue is None or queue.kind not in _QUEUED:
            yield EntityReady(t, entity, 0, 0)
            return
        queue.waits = True
        if queue.kind is EntityKind.CLIENT:
            oldest = next(iter(self._pending[self._names[entity]]), 0)
            yield from self._arrived(t, queue, oldest)
            return
        for sending in list(filter(queue.is_reached_by, queue.untaken))[-queue.depth :]:
            if sending.number not in queue.told:
                yield from self._arrived(t, queue, sending.number)
        if not queue.told:  # by somebody whom no probe watches
            yield EntityReady(t, entity, 1, 0)

    def waits_no_more(self, entity: int) -> None:
        """Note that an entity no longer waits."""
        if entity in self._queues:
            self._queues[entity].waits = False

    def taken(self, t: int, entity: int, sent: int) -> tuple[int, int, list[AnyEvent]]:
        """Note that the message sent at ``sent`` (nanoseconds since 1970) was taken from a queue.

        Returns its number (0 if the sender is not watched), the queue's new length, and what was lost before.
        """
        queue = self._queues.get(entity)
        if queue is None:
            return 0, 0, []
        for place, sending in enumerate(queue.untaken):
            if sending.before <= sent <= sending.after:
                passed = [each for each in list(queue.untaken)[:place] if each.sender == sending.sender]
                lost: list[AnyEvent] = []
                if queue.kind is EntityKind.SUBSCRIPTION:
                    lost = [event for each in passed for event in self._passed(t, queue, each)]
                    queue.hears(sending.sender)
                else:
                    queue.handled[sent] = sending.number
                    if len(queue.handled) > _REMEMBERED:
                        del queue.handled[next(iter(queue.handled))]
                queue.untaken.remove(sending)
                self._leaves(queue, sending.number)
                return sending.number, len(queue.told), lost
        queue.early.append(sent)
        return 0, len(queue.told), []

    def reply_taken(self, entity: int, call: int) -> tuple[int, int]:
        """Note that a client took the reply of a call; returns its number, and how many replies are left."""
        queue = self._queues.get(entity)
        if queue is None:
            return call, 0
        self._leaves(queue, call)
        return call, len(queue.told)

    def _passed(self, t: int, queue: _Queue, sending: SentMessage) -> Iterator[AnyEvent]:
        """Yield the loss of a skipped message, unless discovery had not connected its sender yet."""
        if sending.sender in queue.heard or sending.number in queue.told:
            yield from self._lost(t, queue, sending)
        else:
            queue.untaken.remove(sending)

    def _lost(self, t: int, queue: _Queue, sending: SentMessage) -> Iterator[AnyEvent]:
        queue.untaken.remove(sending)
        self._leaves(queue, sending.number)
        yield MessageDropped(t, queue.entity, len(queue.told), sending.number)

    def _arrived(self, t: int, queue: _Queue, number: int) -> Iterator[AnyEvent]:
        if queue.kind is EntityKind.SUBSCRIPTION and len(queue.told) == queue.depth:
            oldest = next(each for each in queue.untaken if each.number == queue.told[0])
            yield from self._lost(t, queue, oldest)
        queue.told.append(number)
        yield EntityReady(t, queue.entity, len(queue.told), number)

    def _leaves(self, queue: _Queue, number: int) -> None:
        if number in queue.told:
            queue.told.remove(number)


_QUEUED = (EntityKind.SUBSCRIPTION, EntityKind.SERVICE, EntityKind.CLIENT)
