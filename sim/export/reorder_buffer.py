"""A reorder buffer: sorts a stream of events by time, with a short look-ahead."""

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Sequence
from enum import Enum, auto
from operator import attrgetter

import msgspec

from sim.quantities.nanoseconds import SECOND
from sim.trace.events import (
    AnyEvent,
    EntityAppeared,
    EntityId,
    EntityKind,
    EntityReady,
    WaitEnded,
    WaitStarted,
)
from sim.trace.model import Nanoseconds

HORIZON: Nanoseconds = SECOND
_time = attrgetter("t")


class PayloadKind(Enum):
    """What arrives in an entity's queue; requests and replies have the number of their call."""

    MESSAGE = auto()
    REQUEST = auto()
    REPLY = auto()


def payload_kind(kind: EntityKind | None) -> PayloadKind:
    """What arrives in the queues of entities of a kind."""
    if kind is EntityKind.SERVICE:
        return PayloadKind.REQUEST
    return PayloadKind.REPLY if kind is EntityKind.CLIENT else PayloadKind.MESSAGE


class ReorderBuffer:
    """Releases events in order of time; events of the same time in order of arrival.

    Threads record slightly out of order, and a wait is recorded when its reason is known but starts when its
    callback became ready. So events stay in the buffer until the stream is a ``horizon`` further. A later one
    is moved to the latest released time: times never decrease.

    The buffered events also show who is about to receive a message. Memory: two horizons of events.
    """

    def __init__(self, horizon: Nanoseconds = HORIZON) -> None:
        self._horizon = horizon
        self._held: list[AnyEvent] = []
        self.latest: Nanoseconds = 0
        """The time of the latest event."""
        self._released_until: Nanoseconds = 0
        self._wait_series: dict[EntityId, tuple[Nanoseconds, Nanoseconds | None]] = {}
        self._kinds: dict[EntityId, EntityKind] = {}
        self._receivers: defaultdict[tuple[PayloadKind, int], list[EntityId]] = defaultdict(list)

    def take(self, events: Sequence[AnyEvent]) -> Sequence[AnyEvent]:
        """Add a batch; return the events whose order is final."""
        held = self._held
        latest, earliest = self.latest, self._released_until
        for event in events:
            kind = event.__class__
            placed = event
            if kind is EntityReady or kind is WaitStarted or kind is WaitEnded or kind is EntityAppeared:
                placed = self._note(event)
            if placed.t < earliest:
                placed = msgspec.structs.replace(placed, t=earliest)
            latest = max(latest, event.t)
            held.append(placed)
        self.latest = latest
        if not held or latest - held[0].t < 2 * self._horizon:
            return ()
        return self._release(latest - self._horizon)

    def flush(self) -> Sequence[AnyEvent]:
        """Release all buffered events, at the end of the stream."""
        return self._release(self.latest)

    def receivers(self, payload: PayloadKind, number: int) -> Sequence[EntityId]:
        """The entities that will receive a message, request or reply; they are forgotten with this call."""
        return self._receivers.pop((payload, number), ())

    def forget(self, event: EntityReady) -> None:
        """Drop the receivers of what arrived with this event."""
        self._receivers.pop((payload_kind(self._kinds.get(event.entity)), event.message), None)

    def _release(self, until: Nanoseconds) -> Sequence[AnyEvent]:
        self._held.sort(key=_time)
        after = bisect_right(self._held, until, key=_time)
        settled, self._held = self._held[:after], self._held[after:]
        if settled:
            self._released_until = settled[-1].t
        return settled

    def _note(self, event: AnyEvent) -> AnyEvent:
        if isinstance(event, EntityReady):
            if event.message:
                payload = payload_kind(self._kinds.get(event.entity))
                self._receivers[payload, event.message].append(event.entity)
        elif isinstance(event, WaitStarted):
            return self._backdated(event)
        elif isinstance(event, WaitEnded):
            since, _ = self._wait_series.get(event.entity, (event.t, None))
            self._wait_series[event.entity] = (since, event.t)
        elif isinstance(event, EntityAppeared):
            self._kinds[event.entity] = event.kind
        return event

    def _backdated(self, event: WaitStarted) -> WaitStarted:
        """The event at the start of its wait: the first reason holds since the callback is ready."""
        since, ended = self._wait_series.get(event.entity, (None, 0))
        self._wait_series[event.entity] = (event.since, None)
        if since == event.since or ended is None or event.since >= event.t:
            return event
        return msgspec.structs.replace(event, t=max(event.since, ended))
