"""The interfaces of groups, nodes, entities and messages that the model's probe uses."""

from collections.abc import Callable
from typing import Any, Protocol

from sim.probes.on_path.cbtui_probe.naming import callback_name
from sim.trace.events import AnyEvent, EntityKind, GroupKind, Reason


class TracedGroup(Protocol):
    """A callback group, as far as the trace shows it."""

    trace_id: int

    @property
    def trace_kind(self) -> GroupKind:
        """How it admits callbacks."""

    @property
    def is_own(self) -> bool:
        """Whether the program made it; else a change to the run did."""


class TracedNode(Protocol):
    """A node, as far as the trace shows it."""

    @property
    def trace_id(self) -> int:
        """Its id on the trace."""


class TracedEntity(Protocol):
    """An entity, as far as the trace shows it."""

    trace_id: int
    wait_shown: tuple[Reason, int, bool] | None

    @property
    def traced(self) -> bool:
        """Whether the trace shows it."""

    @property
    def kind(self) -> EntityKind:
        """Its kind."""

    @property
    def name(self) -> str:
        """Its topic or service; empty for none."""

    @property
    def node(self) -> TracedNode:
        """The node that it belongs to."""

    @property
    def callback_group(self) -> TracedGroup:
        """The group that admits its callback."""

    @property
    def depth(self) -> int:
        """The length of its queue; 0 for none."""

    @property
    def period(self) -> int:
        """The period of a timer in nanoseconds, 0 for others."""

    @property
    def interface_type(self) -> str:
        """The type of its topic or service; empty for none."""

    @property
    def ready_since(self) -> int:
        """When it became ready."""

    def shown_callback(self) -> Callable[..., Any] | None:
        """The function that the trace names; None: it has none of its own."""


def name_of(entity: TracedEntity) -> str:
    """Return the name of an entity's callback; its own if it has none."""
    callback = entity.shown_callback()
    return entity.name if callback is None else callback_name(callback)


class MessageContents(Protocol):
    """Makes events from the contents of messages."""

    @property
    def wanted(self) -> bool:
        """Whether the events are wanted now."""

    @property
    def keeps_messages(self) -> bool:
        """Whether messages are read later, so that a subscription must not get the same object."""

    def events(self, now: int, message: int, topic: str, data: Any, qos: Any) -> list[AnyEvent]:
        """The events besides the publication; ``qos`` is what the publisher offers."""
