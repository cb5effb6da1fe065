"""Callback groups: who may run while who runs."""

from __future__ import annotations

import weakref
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from sim.ros.scheduling.entity import Entity
from sim.trace.events import GroupKind

if TYPE_CHECKING:
    from sim.ros.scheduling.waitable import Waitable

Member: TypeAlias = "Entity | Waitable[Any]"


class CallbackGroup(ABC):
    """Decides when the callbacks of its entities may run; a program may write its own kind.

    Entities are held weakly, in the order of their joining, so that every run is the same. The three
    questions below are asked by executors with the host's lock held.
    """

    trace_kind: ClassVar[GroupKind] = GroupKind.CUSTOM
    trace_id = 0

    def __init__(self) -> None:
        super().__init__()
        self.entities: dict[weakref.ref[Member], None] = {}

    def add_entity(self, entity: Member) -> None:
        """Make an entity a member."""
        self.entities[weakref.ref(entity)] = None

    def has_entity(self, entity: Member) -> bool:
        """Whether an entity is a member."""
        return weakref.ref(entity) in self.entities

    @abstractmethod
    def can_execute(self, entity: Entity) -> bool:
        """Whether the entity's callback may begin now."""

    @abstractmethod
    def beginning_execution(self, entity: Entity) -> bool:
        """Let the entity's callback begin; False refuses it."""

    @abstractmethod
    def ending_execution(self, entity: Entity) -> None:
        """The entity's callback has ended."""


class ReentrantCallbackGroup(CallbackGroup):
    """Lets everything in at any time, the same callback several times at once too."""

    trace_kind = GroupKind.REENTRANT

    def can_execute(self, entity: Entity) -> bool:
        """Whether the entity's callback may begin now: always."""
        return True

    def beginning_execution(self, entity: Entity) -> bool:
        """Let the callback begin: always."""
        return True

    def ending_execution(self, entity: Entity) -> None:
        """Nothing needs to be undone."""


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    """Lets one callback in at a time."""

    trace_kind = GroupKind.EXCLUSIVE

    def __init__(self) -> None:
        super().__init__()
        self._active_entity: Entity | None = None

    @property
    def holder(self) -> Entity | None:
        """The entity whose callback is inside."""
        return self._active_entity

    def can_execute(self, entity: Entity) -> bool:
        """Whether nobody is inside. The entity must be a member."""
        assert weakref.ref(entity) in self.entities
        return self._active_entity is None

    def beginning_execution(self, entity: Entity) -> bool:
        """Let the callback in if nobody is inside."""
        assert weakref.ref(entity) in self.entities
        if self._active_entity is None:
            self._active_entity = entity
            return True
        return False

    def ending_execution(self, entity: Entity) -> None:
        """Free the group."""
        assert self._active_entity is entity
        self._active_entity = None
