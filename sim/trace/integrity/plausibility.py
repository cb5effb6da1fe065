"""Checks whether a trace can be that of a run on virtual time: its order, ids, queues and groups."""

from collections import Counter
from collections.abc import Iterable
from typing import TypeAlias

from sim.trace import events as ev
from sim.trace.events import AnyEvent, EntityId, GroupId, GroupKind, ThreadId
from sim.trace.integrity.message_counts import MessageCounts
from sim.trace.model import Nanoseconds

_MOST_FAULTS = 2
"""Limit for the reported faults, since one fault causes others."""
_INTRODUCED: dict[type, str] = {
    ev.ProcessAppeared: "process",
    ev.ThreadAppeared: "thread",
    ev.ExecutorAppeared: "executor",
    ev.NodeAppeared: "node",
    ev.GroupAppeared: "group",
    ev.EntityAppeared: "entity",
}
"""The events that introduce an id, and the field that has it: the ids of a kind are 1, 2, 3 and so on."""
_KINDS = frozenset(_INTRODUCED.values())
_HOLDER = "holder"
"""The field that refers to an entity by another name."""
_NO_THREAD: ThreadId = 0
_CallbackOnThread: TypeAlias = tuple[EntityId, ThreadId]
"""A callback and its thread; a suspended callback has ``_NO_THREAD``."""


class Plausibility:
    """Takes the events of a run in order; ``faults`` are sentences on what no run can produce."""

    def __init__(self) -> None:
        self.faults: list[str] = []
        self._queues = MessageCounts()
        self._now: Nanoseconds = 0
        self._started = self._ended = False
        self._known = Counter[str]()
        self._exclusive: set[GroupId] = set()
        self._groups: dict[EntityId, GroupId] = {}
        self._running = Counter[_CallbackOnThread]()
        self._inside = Counter[GroupId]()

    def take(self, events: Iterable[AnyEvent]) -> None:
        """Check the next events."""
        batch = [*events]
        for event in batch:
            self._take_in_order(event)
            self._take_references(event)
            self._take_callback(event)
        self._queues.take(batch)

    def finish(self) -> None:
        """Check that the run came to its end, once all events have been taken."""
        self.faults += self._queues.faults
        if not self._ended:
            self._complain(self._now, "the trace stops before the end of the run")

    def _take_in_order(self, event: AnyEvent) -> None:
        if self._ended:
            self._complain(event.t, f"{_name(event)} came after the end of the run")
        if isinstance(event, ev.RunStarted) == self._started:
            self._complain(event.t, "the run began twice" if self._started else f"{_name(event)} came first")
        self._started = True
        if event.t < self._now:
            self._complain(event.t, f"{_name(event)} came after an event of {self._now} ns")
        self._now = max(self._now, event.t)
        self._ended = isinstance(event, ev.RunEnded)

    def _take_references(self, event: AnyEvent) -> None:
        introduced = _INTRODUCED.get(type(event))
        for field in event.__struct_fields__:
            kind = "entity" if field == _HOLDER else field
            number = getattr(event, field)
            if field == introduced:
                self._known[kind] += 1
                if number != self._known[kind]:
                    self._complain(event.t, f"{kind} {number} appeared in place of {self._known[kind]}")
            elif kind in _KINDS and not 0 <= number <= self._known[kind]:
                self._complain(event.t, f"{_name(event)} names {kind} {number}, which had not appeared")

    def _take_callback(self, event: AnyEvent) -> None:
        match event:
            case ev.GroupAppeared(group=group, kind=GroupKind.EXCLUSIVE):
                self._exclusive.add(group)
            case ev.EntityAppeared(entity=entity, group=group):
                self._groups[entity] = group
            case ev.CallbackStarted(entity=entity, thread=thread):
                self._running[entity, thread] += 1
                self._admit(event.t, self._groups.get(entity, 0))
            case ev.CallbackSuspended(entity=entity, thread=thread):
                self._move(event, (entity, thread), (entity, _NO_THREAD))
            case ev.CallbackResumed(entity=entity, thread=thread):
                self._move(event, (entity, _NO_THREAD), (entity, thread))
            case ev.CallbackEnded(entity=entity, thread=thread):
                self._move(event, (entity, thread), None)
                self._inside[self._groups.get(entity, 0)] -= 1

    def _admit(self, now: Nanoseconds, group: GroupId) -> None:
        self._inside[group] += 1
        if group in self._exclusive and self._inside[group] > 1:
            self._complain(now, f"two callbacks run at once in the exclusive group {group}")

    def _move(self, event: AnyEvent, place: _CallbackOnThread, to: _CallbackOnThread | None) -> None:
        if self._running[place] < 1:
            self._complain(event.t, f"{_name(event)} is of a callback that was not running")
        self._running[place] -= 1
        if to is not None:
            self._running[to] += 1

    def _complain(self, now: Nanoseconds, what: str) -> None:
        if len(self.faults) < _MOST_FAULTS:
            self.faults.append(f"at {now} ns {what}")


def _name(event: AnyEvent) -> str:
    return type(event).__name__
