"""The wait set of a program's own waitables: entities by kind and index, and which of them are ready."""

from functools import partialmethod
from typing import Any, TypeAlias

from sim.ros.exceptions import RCLError
from sim.ros.handle import Handle
from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.waitable import NumberOfEntities
from sim.ros.scheduling.watched import BareEntity, Watcher

_KINDS = ("subscription", "guard_condition", "timer", "client", "service", "event")


Waited: TypeAlias = "Entity | BareEntity"


class ProgramWaitSet:
    """The entities that the waitables of one executor wait for in one cycle.

    An entity is given by itself or by its handle. ``room`` is the announced number of each kind.
    """

    def __init__(self, room: NumberOfEntities) -> None:
        self._room = {kind: getattr(room, f"num_{kind}s") for kind in _KINDS}
        self._waited: dict[str, list[Waited]] = {kind: [] for kind in _KINDS}
        self._ready: dict[str, list[bool]] = {kind: [] for kind in _KINDS}

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

    # Each adds an entity, or its handle, and returns the index of the entity.
    add_subscription = partialmethod(_add, "subscription")
    add_guard_condition = partialmethod(_add, "guard_condition")
    add_timer = partialmethod(_add, "timer")
    add_client = partialmethod(_add, "client")
    add_service = partialmethod(_add, "service")
    add_event = partialmethod(_add, "event")

    def is_ready(self, kind: str, index: int) -> bool:
        """Whether the entity of that kind and index was ready at the last ``look``.

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
        """The pointers of the handles of the ready entities of a kind."""
        if kind not in _KINDS:
            raise RuntimeError(f"'{kind}' is not a known entity")
        both = zip(self._waited[kind], self._ready[kind], strict=True)
        return [Handle(each).pointer for each, ready in both if ready]

    def check(self, watcher: Watcher, now: int) -> int | None:
        """Note which entities are ready, and wake ``watcher`` once more are. Return the next due time.

        Called with the host's lock held.
        """
        dues: list[int] = []
        for kind, waited in self._waited.items():
            self._ready[kind] = [self._is_ready(each, watcher, now) for each in waited]
            dues.extend(due for each in waited if (due := self._due(each)) is not None and due > now)
        return min(dues, default=None)

    def _is_ready(self, waited: Waited, watcher: Watcher, now: int) -> bool:
        if isinstance(waited, BareEntity):
            return waited.check(watcher, now)
        return self._entity_is_ready(waited, watcher, now)

    def _due(self, waited: Waited) -> int | None:
        return waited.next_due() if isinstance(waited, BareEntity) else self._entity_due(waited)

    def _entity_is_ready(self, entity: Entity, watcher: Watcher, now: int) -> bool:
        if entity.node._agenda.executor is not watcher:
            raise NotImplementedError("waiting for an entity that another executor serves is not supported")
        return entity.ready_at(now)

    def _entity_due(self, _entity: Entity) -> int | None:
        """None: the executor that serves the entity knows its due time."""
        return None
