"""The wait set as a program's own waitables see it: entities by kind and index, and which are ready."""

from __future__ import annotations

from typing import Any, TypeAlias

from sim.ros.exceptions import RCLError
from sim.ros.handle import Handle
from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.waitable import NumberOfEntities
from sim.ros.scheduling.watched import BareEntity, Watcher

_KINDS = ("subscription", "guard_condition", "timer", "client", "service", "event")


Waited: TypeAlias = "Entity | BareEntity"


class ProgramWaitSet:
    """What the waitables of one executor wait for in one cycle.

    Entities are given as they are or by their handle. ``room`` is how many of each kind were announced.
    """

    def __init__(self, room: NumberOfEntities) -> None:
        self._room = {kind: getattr(room, f"num_{kind}s") for kind in _KINDS}
        self._waited: dict[str, list[Waited]] = {kind: [] for kind in _KINDS}
        self._ready: dict[str, list[bool]] = {kind: [] for kind in _KINDS}

    def add_subscription(self, subscription: Any) -> int:
        """Add a subscription; returns its index."""
        return self._add("subscription", subscription)

    def add_guard_condition(self, guard_condition: Any) -> int:
        """Add a guard condition; returns its index."""
        return self._add("guard_condition", guard_condition)

    def add_timer(self, timer: Any) -> int:
        """Add a timer; returns its index."""
        return self._add("timer", timer)

    def add_client(self, client: Any) -> int:
        """Add a client; returns its index."""
        return self._add("client", client)

    def add_service(self, service: Any) -> int:
        """Add a service; returns its index."""
        return self._add("service", service)

    def add_event(self, event: Any) -> int:
        """Add an event handler; returns its index."""
        return self._add("event", event)

    def is_ready(self, kind: str, index: int) -> bool:
        """Whether the entity of that kind and index was ready when the wait set was looked at.

        Raises:
            RuntimeError: there is no such kind.
            IndexError: there is no such entity.
        """
        if kind not in _KINDS:
            raise RuntimeError(f"'{kind}' is not a known entity")
        ready = self._ready[kind]
        if not 0 <= index < len(ready):
            raise IndexError("wait set index too big")
        return ready[index]

    def get_ready_entities(self, kind: str) -> list[int]:
        """The pointers of the ready entities of a kind, as their handles tell them."""
        if kind not in _KINDS:
            raise RuntimeError(f"'{kind}' is not a known entity")
        both = zip(self._waited[kind], self._ready[kind], strict=True)
        return [Handle(each).pointer for each, ready in both if ready]

    def look(self, watcher: Watcher, now: int) -> int | None:
        """Note what is ready, and have ``watcher`` woken once more is; returns when the next timer falls due.

        With the host's lock held.
        """
        dues: list[int] = []
        for kind, waited in self._waited.items():
            self._ready[kind] = [self._is_ready(each, watcher, now) for each in waited]
            dues.extend(due for each in waited if (due := self._due(each)) is not None and due > now)
        return min(dues, default=None)

    def _add(self, kind: str, given: Any) -> int:
        waited = given.owner if isinstance(given, Handle) else given
        if not isinstance(waited, Entity | BareEntity):
            raise TypeError(f"a wait set takes entities and their handles, got {type(given)}")
        if len(self._waited[kind]) >= self._room[kind]:
            raise RCLError(
                f"Failed to add '{kind}' to wait set: {kind}s set is full; get_num_entities() must count it"
            )
        self._waited[kind].append(waited)
        return len(self._waited[kind]) - 1

    def _is_ready(self, waited: Waited, watcher: Watcher, now: int) -> bool:
        if isinstance(waited, BareEntity):
            return waited.look(watcher, now)
        return self._entity_is_ready(waited, watcher, now)

    def _due(self, waited: Waited) -> int | None:
        return waited.next_due() if isinstance(waited, BareEntity) else self._entity_due(waited)

    def _entity_is_ready(self, entity: Entity, watcher: Watcher, now: int) -> bool:
        if entity.node._agenda.executor is not watcher:
            raise NotImplementedError("waiting for an entity that another executor serves is not supported")
        return entity.ready_at(now)

    def _entity_due(self, _entity: Entity) -> int | None:
        """None: the executor that serves it knows when it falls due."""
        return None
