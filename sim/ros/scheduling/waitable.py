"""Waitables: a program's own entities, which an executor serves before all others."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from sim.ros.scheduling.task import Future

if TYPE_CHECKING:
    from sim.ros.scheduling.callback_groups import CallbackGroup
    from sim.ros.scheduling.program_wait_set import ProgramWaitSet

T = TypeVar("T")


@dataclass
class NumberOfEntities:
    """How many entities of each kind a waitable waits for; two objects can be added."""

    num_subscriptions: int = 0
    num_guard_conditions: int = 0
    num_timers: int = 0
    num_clients: int = 0
    num_services: int = 0
    num_events: int = 0

    def __add__(self, other: NumberOfEntities) -> NumberOfEntities:
        return NumberOfEntities(
            **{each.name: getattr(self, each.name) + getattr(other, each.name) for each in fields(self)}
        )


class Waitable(Generic[T]):
    """Base of the waitables that a program writes; ``Node.add_waitable`` adds one to a node.

    In every cycle of its executor in which its group admits it, a waitable adds its entities to a wait
    set, and is then asked whether it is ready. If so, it takes its data at its turn, and executes
    with them. The model holds no lock meanwhile, so that a waitable may have a lock of its own.
    """

    def __init__(self, callback_group: CallbackGroup) -> None:
        self.callback_group = callback_group
        self.callback_group.add_entity(self)
        self._futures: list[Future[Any]] = []

    def __enter__(self) -> None:
        """Keep its entities alive during a wait; an InvalidHandle leaves the waitable out of this cycle."""

    def __exit__(self, *_error: object) -> None:
        """Release its entities."""

    def add_future(self, future: Future[Any]) -> None:
        """Assign a future to the executor that serves the waitable."""
        self._futures.append(future)

    def remove_future(self, future: Future[Any]) -> None:
        """Remove a future; ValueError if it was not added."""
        self._futures.remove(future)

    def is_ready(self, wait_set: ProgramWaitSet) -> bool:
        """Whether the waitable has data to take."""
        raise NotImplementedError("Must be implemented by subclass")

    def take_data(self) -> T:
        """Take the data for ``execute``, so that the waitable is not ready for them again."""
        raise NotImplementedError("Must be implemented by subclass")

    async def execute(self, taken_data: T) -> None:
        """Process the data."""
        raise NotImplementedError("Must be implemented by subclass")

    def get_num_entities(self) -> NumberOfEntities:
        """The largest number of entities of each kind that ``add_to_wait_set`` adds."""
        raise NotImplementedError("Must be implemented by subclass")

    def add_to_wait_set(self, wait_set: ProgramWaitSet) -> None:
        """Add its entities, and keep their indices for ``is_ready``."""
        raise NotImplementedError("Must be implemented by subclass")
