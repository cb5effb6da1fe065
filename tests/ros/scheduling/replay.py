"""Follows a trace event by event with a model of its own, so that it can be checked at any moment."""

from collections import Counter, deque
from collections.abc import Iterator

from sim.ros.clocks.ros_time_schedule import next_due
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackStarted,
    EntityAppeared,
    EntityId,
    EntityKind,
    EntityReady,
    GroupAppeared,
    GroupKind,
    MessageDropped,
    MessageId,
    WaitEnded,
    WaitStarted,
)
from tests.support.simulation import Trace


class Replay:
    """What runs, queues, is due and waits after the events taken so far."""

    def __init__(self, trace: Trace) -> None:
        self._trace = trace
        self.entities: dict[EntityId, EntityAppeared] = {}
        self.exclusive: dict[int, bool] = {}
        self.running: Counter[EntityId] = Counter()
        self.queues: dict[EntityId, deque[MessageId]] = {}
        self.removed: dict[EntityId, list[MessageId]] = {}
        self.due: dict[EntityId, int] = {}
        self.waiting: dict[EntityId, WaitStarted] = {}

    def jumps(self) -> Iterator[int]:
        """Take all events; yields each time at which time passes, before it does."""
        now = 0
        for event in self._trace.events:
            if event.t > now:
                yield now
                now = event.t
            self.take(event)

    def take(self, event: AnyEvent) -> None:
        """Take the next event."""
        match event:
            case GroupAppeared():
                self.exclusive[event.group] = event.kind == GroupKind.EXCLUSIVE
            case EntityAppeared():
                self._appear(event)
            case EntityReady():
                self.queues[event.entity].append(event.message)
            case MessageDropped():
                self._remove(event.entity, event.message)
            case CallbackStarted():
                self._start(event)
            case CallbackEnded():
                self.running[event.entity] -= 1
            case WaitStarted():
                self.waiting[event.entity] = event
            case WaitEnded():
                del self.waiting[event.entity]
            case _:
                pass

    def _appear(self, event: EntityAppeared) -> None:
        self.entities[event.entity] = event
        self.queues[event.entity] = deque()
        self.removed[event.entity] = []
        if event.kind == EntityKind.TIMER:
            self.due[event.entity] = event.t + event.period

    def _start(self, event: CallbackStarted) -> None:
        if event.entity in self.due:
            due = event.t - event.age
            assert due == self.due[event.entity], (
                "a timer's call tells another due time than the last one set"
            )
            self.due[event.entity] = next_due(due, self.entities[event.entity].period, event.t)
        else:
            self._remove(event.entity, event.message)
        self.running[event.entity] += 1

    def _remove(self, entity: EntityId, message: MessageId) -> None:
        assert self.queues[entity].popleft() == message, "it was not the oldest"
        self.removed[entity].append(message)

    def ready(self, now: int) -> list[EntityId]:
        """The entities that have something to take."""
        return [
            entity
            for entity in self.entities
            if self.queues[entity] or (entity in self.due and self.due[entity] <= now)
        ]

    def inside(self, entity: EntityId) -> list[EntityId]:
        """Who runs in the entity's group."""
        group = self.entities[entity].group
        return [other for other in self.running.elements() if self.entities[other].group == group]

    def may_enter(self, entity: EntityId) -> bool:
        """Whether the entity's group would let it in."""
        return not (self.exclusive[self.entities[entity].group] and self.inside(entity))
