"""Sorts a stream of events by time, and looks a short way ahead in it."""

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Sequence
from enum import Enum, auto
from operator import attrgetter

import msgspec

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
from sim.units import SECOND

HORIZON: Nanoseconds = SECOND
_time = attrgetter("t")


class Parcel(Enum):
    """What travels to an entity's queue. Messages have numbers of their own; calls share theirs."""

    MESSAGE = auto()
    REQUEST = auto()
    REPLY = auto()


def parcel_for(kind: EntityKind | None) -> Parcel:
    """What comes to entities of a kind."""
    if kind is EntityKind.SERVICE:
        return Parcel.REQUEST
    return Parcel.REPLY if kind is EntityKind.CLIENT else Parcel.MESSAGE


class InOrder:
    """Hands events on in order of time; of one time, in order of arrival.

    Threads record a little out of order, and a wait is recorded when its reason is known but begins when its
    callback became ready. So events are held back until the stream is a ``horizon`` further. One that comes
    later than that is moved to the latest time that was handed on: times never fall.

    The held-back part also tells who is about to receive something. Memory: two horizons of events.
    """

    def __init__(self, horizon: Nanoseconds = HORIZON) -> None:
        self._horizon = horizon
        self._held: list[AnyEvent] = []
        self._latest: Nanoseconds = 0
        self._handed_on: Nanoseconds = 0
        self._series: dict[EntityId, tuple[Nanoseconds, Nanoseconds | None]] = {}
        self._kinds: dict[EntityId, EntityKind] = {}
        self._receivers: defaultdict[tuple[Parcel, int], list[EntityId]] = defaultdict(list)

    def take(self, events: Sequence[AnyEvent]) -> Sequence[AnyEvent]:
        """Add a batch; return the events whose order is final."""
        held = self._held
        latest, floor = self._latest, self._handed_on
        for event in events:
            kind = event.__class__
            placed = event
            if kind is EntityReady or kind is WaitStarted or kind is WaitEnded or kind is EntityAppeared:
                placed = self._noted(event)
            if placed.t < floor:
                placed = msgspec.structs.replace(placed, t=floor)
            latest = max(latest, event.t)
            held.append(placed)
        self._latest = latest
        if not held or latest - held[0].t < 2 * self._horizon:
            return ()
        return self._hand_on(latest - self._horizon)

    @property
    def latest(self) -> Nanoseconds:
        """The latest time of any event so far."""
        return self._latest

    def rest(self) -> Sequence[AnyEvent]:
        """The events that are still held back, at the end of the stream."""
        return self._hand_on(self._latest)

    def receivers(self, parcel: Parcel, number: int) -> Sequence[EntityId]:
        """Who receives the message, request or reply of that number soon; can be asked once."""
        return self._receivers.pop((parcel, number), ())

    def forget(self, event: EntityReady) -> None:
        """Nobody will ask any more who receives what arrived here."""
        self._receivers.pop((parcel_for(self._kinds.get(event.entity)), event.message), None)

    def _hand_on(self, until: Nanoseconds) -> Sequence[AnyEvent]:
        self._held.sort(key=_time)
        after = bisect_right(self._held, until, key=_time)
        settled, self._held = self._held[:after], self._held[after:]
        if settled:
            self._handed_on = settled[-1].t
        return settled

    def _noted(self, event: AnyEvent) -> AnyEvent:
        if isinstance(event, EntityReady):
            if event.message:
                parcel = parcel_for(self._kinds.get(event.entity))
                self._receivers[parcel, event.message].append(event.entity)
        elif isinstance(event, WaitStarted):
            return self._since(event)
        elif isinstance(event, WaitEnded):
            since, _ = self._series.get(event.entity, (event.t, None))
            self._series[event.entity] = (since, event.t)
        elif isinstance(event, EntityAppeared):
            self._kinds[event.entity] = event.kind
        return event

    def _since(self, event: WaitStarted) -> WaitStarted:
        """The event at the time when the wait began: its first reason holds since the callback is ready."""
        since, ended = self._series.get(event.entity, (None, 0))
        self._series[event.entity] = (event.since, None)
        if since == event.since or ended is None or event.since >= event.t:
            return event
        return msgspec.structs.replace(event, t=max(event.since, ended))
