"""Callback groups: they decide which callbacks may run at the same time."""

import weakref
from abc import ABC, abstractmethod
from typing import Any, ClassVar, TypeAlias

from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.waitable import Waitable
from sim.trace.events import GroupKind

Member: TypeAlias = "Entity | Waitable[Any]"


class CallbackGroup(ABC):
    """Decides when the callbacks of its entities may run. A program may write a subclass.

    Entities are held weakly, in the order in which they were added, so that all runs are equal. Executors
    call the three abstract methods with the host's lock held.
    """

    trace_kind: ClassVar[GroupKind] = GroupKind.CUSTOM
    trace_id = 0
    is_own = True
    """Whether the program made it; else a change to the run did."""

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
        """Whether the entity's callback may start now."""

    @abstractmethod
    def beginning_execution(self, entity: Entity) -> bool:
        """Admit the entity's callback; False: it is refused."""

    @abstractmethod
    def ending_execution(self, entity: Entity) -> None:
        """The entity's callback has ended."""


class ReentrantCallbackGroup(CallbackGroup):
    """Admits every callback at any time, also the same callback several times at once."""

    trace_kind = GroupKind.REENTRANT

    def can_execute(self, entity: Entity) -> bool:
        """True: the entity's callback may always start."""
        return True

    def beginning_execution(self, entity: Entity) -> bool:
        """True: the callback is admitted."""
        return True

    def ending_execution(self, entity: Entity) -> None:
        """Do nothing."""


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    """Admits one callback at a time."""

    trace_kind = GroupKind.EXCLUSIVE

    def __init__(self) -> None:
        super().__init__()
        self._active_entity: Entity | None = None

    @property
    def holder(self) -> Entity | None:
        """The entity whose callback runs."""
        return self._active_entity

    def can_execute(self, entity: Entity) -> bool:
        """Whether no callback of the group runs. The entity must be a member."""
        assert weakref.ref(entity) in self.entities
        return self._active_entity is None

    def beginning_execution(self, entity: Entity) -> bool:
        """Admit the callback if no callback of the group runs."""
        assert weakref.ref(entity) in self.entities
        if self._active_entity is None:
            self._active_entity = entity
            return True
        return False

    def ending_execution(self, entity: Entity) -> None:
        """Free the group."""
        assert self._active_entity is entity
        self._active_entity = None
