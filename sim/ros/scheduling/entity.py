"""Entities: they become ready, and an executor then runs their callback once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import GenericAlias
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, runtime_checkable

import msgspec

from sim.ros.clocks.clock import Clock
from sim.ros.context.context import Context
from sim.ros.handle import Handle
from sim.ros.logging.logger import RcutilsLogger
from sim.trace.events import EntityKind, Reason

if TYPE_CHECKING:
    from sim.ros.scheduling.agenda import Agenda
    from sim.ros.scheduling.callback_groups import CallbackGroup

NEVER = 1 << 62
"""The due time of an entity that time alone does not make ready."""


@runtime_checkable
class OwnerNode(Protocol):
    """The node of entities, as entities and executors use it."""

    _agenda: Agenda
    trace_id: int
    executor: Any

    @property
    def context(self) -> Context:
        """The node's context."""

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The group of all entities that are created without one."""

    def get_name(self) -> str:
        """The node's name without namespace."""

    def get_namespace(self) -> str:
        """The node's namespace."""

    def get_fully_qualified_name(self) -> str:
        """The node's namespace and name."""

    def get_clock(self) -> Clock:
        """The node's clock."""

    def get_logger(self) -> RcutilsLogger:
        """The node's logger."""

    def resolve_topic_name(self, topic: str) -> str:
        """The full name of a topic of this node."""

    def resolve_service_name(self, service: str) -> str:
        """The full name of a service of this node."""

    def create_publisher(self, msg_type: type, topic: str, qos_profile: Any, /) -> Any:
        """Create a publisher."""


class TakenData(msgspec.Struct, frozen=True, gc=False):
    """The data that one take got for a callback, and what the trace records about the take."""

    data: Any
    message: int
    age: int
    left: int


class Entity:
    """Base of timers, subscriptions, guard conditions, clients and services.

    The host's lock guards all attributes. ``handed_out`` is set from the moment at which an executor yields
    the entity until its handler runs; meanwhile no executor yields it again. ``entered_in`` is the number of
    the gathering in which its callback last started, and which leaves it out. ``pending``: the entity has
    something to take. ``stuck``: a take failed, so that the entity stays handed out and its group held.
    """

    kind: EntityKind
    rank: ClassVar[int]
    """The position of this kind in the order in which a snapshot is served."""

    traced = True
    """Whether the trace shows the entity."""

    served = True
    """Whether it is called by itself; if not, what it is a part of is."""

    arrived_at: Entity | None = None
    """What the latest arrived at, where several things make it ready."""

    due = NEVER
    """When the entity becomes ready by time alone, in nanoseconds of the run's clock."""

    entered_at = 0
    """When its callback last began, in nanoseconds of the run's clock."""

    task_number = 0
    """The number of the task that calls it: rclpy makes it where an executor yields the entity."""

    reset_unheard = False
    """Whether a timer was reset when no EventsExecutor heard of it; the one that adds it will."""

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
        """A handle that keeps the entity alive while it is used."""
        return Handle(self)

    @property
    def logger_name(self) -> str:
        """The name of the node's logger."""
        return self.node.get_logger().name

    def destroy(self) -> None:
        """Remove the entity from its node."""
        self.node._agenda.remove(self)

    def removed(self) -> None:
        """The entity was removed from its node. Called with the host's lock held."""

    def __enter__(self) -> Self:
        self.node.context.host.profile.require_with_blocks(self)
        return self

    def __exit__(self, *_error: object) -> None:
        self.destroy()

    def require_alive(self) -> None:
        """Raise InvalidHandle if the entity was destroyed; while its handle is entered it counts as alive."""
        if self.destroyed:
            with self.handle:
                return

    def shown_callback(self) -> Callable[..., Any] | None:
        """The function that the program gave the entity to call; None if the entity has none."""
        return getattr(self, "callback", None)

    def take(self, now: int) -> TakenData | None:
        """Take the data for the callback; None: there is none. Called with the host's lock held."""
        raise NotImplementedError

    def invoke(self, taken: TakenData) -> Any:
        """Run the callback, without the lock; the executor drives a returned coroutine."""
        raise NotImplementedError

    def ready_at(self, now: int) -> bool:
        """Whether a wait set finds the entity ready at ``now``."""
        return self.pending

    def falls_due(self, due: int) -> bool:
        """Whether the entity still becomes ready at ``due`` by time alone."""
        return self.due == due and not (self.pending or self.destroyed)

    def on_snapshot(self) -> None:
        """A snapshot includes this entity."""

    def still_ready(self, now: int) -> bool:
        """Whether the entity, which is in a snapshot, may still run when its turn comes."""
        return not self.destroyed

    @property
    def queued(self) -> int:
        """How many items there are to take."""
        return int(self.pending)

    def readiness(self) -> Sequence[int]:
        """The numbers, among all entities, with which it and each more of its parts became ready."""
        return [self.node._agenda.ready[self]]

    def leave_out(self, later: int) -> None:
        """Have the next take leave out parts that became ready with a later number."""

    def arrivals(self) -> Sequence[Entity | None]:
        """For all that there is to take, what it arrived at."""
        return [None] * self.queued

    def expect(self, arrived: Entity | None) -> None:
        """Have the next take be of what arrived there alone, where takes differ."""

    def become_ready(self, since: int) -> None:
        """An item to take has arrived. Called with the host's lock held."""
        if not self.pending:
            self.pending = True
            self.ready_since = since
            self.node._agenda.entity_ready(self)
        else:
            self.node._agenda.entity_has_more(self)

    def become_idle(self) -> None:
        """There is nothing more to take. Called with the host's lock held."""
        if self.pending:
            self.pending = False
            self.node._agenda.entity_idle(self)


def never_called(_data: Any, _more: Any = None) -> None:
    """The callback of an entity whose items are taken without an executor."""
