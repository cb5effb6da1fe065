"""What a wait set is made of: things that become ready and then have their callback run once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import GenericAlias
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, runtime_checkable

import msgspec

from sim.ros.handle import Handle
from sim.trace.events import EntityKind, Reason

if TYPE_CHECKING:
    from sim.ros.clocks.clock import Clock
    from sim.ros.context.context import Context
    from sim.ros.logging.logger import RcutilsLogger
    from sim.ros.scheduling.agenda import Agenda
    from sim.ros.scheduling.callback_groups import CallbackGroup

NEVER = 1 << 62
"""The due time of what time alone does not make ready."""


@runtime_checkable
class OwnerNode(Protocol):
    """The node that entities belong to, as far as they and executors know it."""

    _agenda: Agenda
    trace_id: int
    executor: Any

    @property
    def context(self) -> Context:
        """The context it lives in."""

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The group of all entities that name none."""

    def get_name(self) -> str:
        """Its name without namespace."""

    def get_namespace(self) -> str:
        """Its namespace."""

    def get_fully_qualified_name(self) -> str:
        """Namespace and name."""

    def get_clock(self) -> Clock:
        """Its clock."""

    def get_logger(self) -> RcutilsLogger:
        """Its logger."""

    def resolve_topic_name(self, topic: str) -> str:
        """The full name of a topic as the node means it."""

    def resolve_service_name(self, service: str) -> str:
        """The full name of a service as the node means it."""

    def create_publisher(self, msg_type: type, topic: str, qos_profile: Any, /) -> Any:
        """Make a publisher."""

    def destroy_publisher(self, publisher: Any, /) -> bool:
        """Remove a publisher; whether it was this node's."""


class Taken(msgspec.Struct, frozen=True, gc=False):
    """What one take brought: the data for the callback, and what the trace tells of it."""

    data: Any
    message: int
    age: int
    left: int


class Entity:
    """Base of timers, subscriptions, guard conditions, clients and services.

    All attributes are guarded by the host's lock. ``handed_out`` is set from the moment an executor yields
    the entity until its handler runs; meanwhile no executor yields it again. ``entered_in`` is the number of
    its executor's gathering in which its callback last began, which leaves it out. ``pending`` tells that
    there is something to take. ``stuck``: taking failed, so that it stays handed out and its group held.
    """

    kind: ClassVar[EntityKind]
    rank: ClassVar[int]
    """Place of the kind in the order in which a snapshot is served."""

    traced = True
    """Whether the trace shows it."""

    served = True
    """Whether it is called by itself; if not, what it is a part of is."""

    arrived_at: Entity | None = None
    """What the latest arrived at, where several things make it ready."""

    due = NEVER
    """When it becomes ready by the passing of time alone, on the run's clock."""

    __class_getitem__: ClassVar[Any] = classmethod(GenericAlias)

    def __init__(self, node: OwnerNode, name: str, callback_group: CallbackGroup) -> None:
        self.node = node
        self.name = name
        self.callback_group = callback_group
        self.order = node._agenda.next_order()
        self.handed_out = False
        self.stuck = False
        self.entered_in = 0
        self.pending = False
        self.destroyed = False
        self.ready_since = 0
        self.depth = 0
        self.period = 0
        self.interface_type = ""
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
        self.node._agenda.remove(self)

    def removed(self) -> None:
        """Its node has let it go. With the host's lock held."""

    def __enter__(self) -> Self:
        self.node.context.host.profile.require_with_blocks(self)
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

    def ready_at(self, now: int) -> bool:
        """Whether there is something to take, for a wait set that is looked at ``now``."""
        return self.pending

    def falls_due(self, due: int) -> bool:
        """Whether it still becomes ready at ``due``, by the passing of time alone."""
        return self.due == due and not (self.pending or self.destroyed)

    def noticed(self) -> None:
        """A snapshot names this entity."""

    def still_ready(self, now: int) -> bool:
        """Whether a snapshot that names this entity still holds when its turn comes."""
        return not self.destroyed

    @property
    def queued(self) -> int:
        """How often there is something to take."""
        return int(self.pending)

    def arrivals(self) -> Sequence[Entity | None]:
        """For all that there is to take, what it arrived at."""
        return [None] * self.queued

    def expect(self, arrived: Entity | None) -> None:
        """Have the next take be of what arrived there alone, where takes differ."""

    def become_ready(self, since: int) -> None:
        """There is something to take from now on, or more. With the host's lock held."""
        if not self.pending:
            self.pending = True
            self.ready_since = since
            self.node._agenda.entity_ready(self)
        else:
            self.node._agenda.entity_has_more(self)

    def nothing_left(self) -> None:
        """There is nothing more to take. With the host's lock held."""
        if self.pending:
            self.pending = False
            self.node._agenda.entity_idle(self)


def never_called(_data: Any, _more: Any = None) -> None:
    """Stand in for the callback of an entity from which somebody takes what arrives."""
