"""What a wait set is made of: things that become ready and then have their callback run once."""

from __future__ import annotations

from collections.abc import Callable
from types import GenericAlias
from typing import TYPE_CHECKING, Any, ClassVar, Self

import msgspec

from sim.ros.handle import Handle
from sim.trace.events import EntityKind, Reason

if TYPE_CHECKING:
    from sim.ros.callback_groups import CallbackGroup
    from sim.ros.node import Node


class Taken(msgspec.Struct, frozen=True, gc=False):
    """What one take brought: the data for the callback, and what the trace tells of it."""

    data: Any
    message: int
    age: int
    left: int


class Entity:
    """Base of timers, subscriptions, guard conditions, clients and services.

    All attributes are guarded by the host's lock. ``handed_out`` is set from the moment an executor yields
    the entity until its handler runs; meanwhile no executor yields it again. ``pending`` tells that there
    is something to take.
    """

    kind: ClassVar[EntityKind]
    rank: ClassVar[int]
    """Place of the kind in the order in which a snapshot is served."""

    traced: ClassVar[bool] = True
    """Whether the trace shows it."""

    __class_getitem__: ClassVar[Any] = classmethod(GenericAlias)

    def __init__(self, node: Node, name: str, callback_group: CallbackGroup) -> None:
        self.node = node
        self.name = name
        self.callback_group = callback_group
        self.order = node._agenda.next_order()
        self.handed_out = False
        self.pending = False
        self.destroyed = False
        self.ready_since = 0
        self.depth = 0
        self.period = 0
        self.trace_id = 0
        self.wait_shown: tuple[Reason, int, bool] | None = None
        callback_group.add_entity(self)

    @property
    def handle(self) -> Handle:
        """What keeps it alive while it is used."""
        return Handle(self)

    @property
    def logger_name(self) -> str:
        """The name of its node's logger."""
        return self.node.get_logger().name

    def destroy(self) -> None:
        """Remove it from its node."""
        raise NotImplementedError

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.destroy()

    def require_alive(self) -> None:
        """Raise InvalidHandle if it was destroyed; while its handle is held it counts as alive."""
        if self.destroyed:
            with self.handle:
                return

    def shown_callback(self) -> Callable[..., Any] | None:
        """The function that a learner knows this entity by; None: it has none of its own."""
        raise NotImplementedError

    def take(self, now: int) -> Taken | None:
        """Take what the callback gets; None: nothing is there after all. With the host's lock held."""
        raise NotImplementedError

    def invoke(self, taken: Taken) -> Any:
        """Run the callback; a coroutine it returns is for the executor to drive. Without the lock."""
        raise NotImplementedError

    def still_ready(self, now: int) -> bool:
        """Whether a snapshot that names this entity still holds when its turn comes."""
        return not self.destroyed

    def become_ready(self, since: int) -> None:
        """There is something to take from now on. With the host's lock held."""
        if not self.pending:
            self.pending = True
            self.ready_since = since
            self.node._agenda.entity_ready(self)

    def nothing_left(self) -> None:
        """There is nothing more to take. With the host's lock held."""
        if self.pending:
            self.pending = False
            self.node._agenda.entity_idle(self)
