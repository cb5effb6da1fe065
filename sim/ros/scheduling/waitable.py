"""Waitables: things that a program writes itself to be served by an executor before everything else."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from sim.ros.scheduling.callback_groups import CallbackGroup
    from sim.ros.scheduling.program_wait_set import ProgramWaitSet
    from sim.ros.scheduling.task import Future

T = TypeVar("T")


@dataclass
class NumberOfEntities:
    """How many entities of each kind a waitable waits for; two can be added."""

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
    """Base of the waitables that a program writes; ``Node.add_waitable`` has one served.

    In every cycle of its executor in which its group lets it in, a waitable adds what it waits for to a wait
    set, and is then asked whether it is ready. If so, it takes its data when its turn comes, and executes
    with them. No lock of the model's is held meanwhile, so that a waitable may have one of its own.
    """

    def __init__(self, callback_group: CallbackGroup) -> None:
        self.callback_group = callback_group
        self.callback_group.add_entity(self)
        self._futures: list[Future[Any]] = []

    def __enter__(self) -> None:
        """Hold what it waits for while it is waited for; InvalidHandle leaves it out of this cycle."""

    def __exit__(self, *_error: object) -> None:
        """Hold it no more."""

    def add_future(self, future: Future[Any]) -> None:
        """Have a future belong to the executor that serves this."""
        self._futures.append(future)

    def remove_future(self, future: Future[Any]) -> None:
        """Let a future go; ValueError if it was not added."""
        self._futures.remove(future)

    def is_ready(self, wait_set: ProgramWaitSet) -> bool:
        """Whether it has something to take."""
        raise NotImplementedError("Must be implemented by subclass")

    def take_data(self) -> T:
        """Take what ``execute`` gets, so that it is not ready for it again."""
        raise NotImplementedError("Must be implemented by subclass")

    async def execute(self, taken_data: T) -> None:
        """Work on what was taken."""
        raise NotImplementedError("Must be implemented by subclass")

    def get_num_entities(self) -> NumberOfEntities:
        """How many entities of each kind ``add_to_wait_set`` adds at most."""
        raise NotImplementedError("Must be implemented by subclass")

    def add_to_wait_set(self, wait_set: ProgramWaitSet) -> None:
        """Add what it waits for, and keep the indices to ask by."""
        raise NotImplementedError("Must be implemented by subclass")
