"""The base of event handlers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from sim.launch.launch.action import LaunchDescriptionEntity
from sim.launch.launch.event import Event

if TYPE_CHECKING:
    from sim.launch.launch.launch_context import LaunchContext

Reaction = Any
"""An entity, entities, or a callable of event and context that returns them or None."""


class EventHandler:
    """Returns the entities to visit when a matching event happens."""

    def __init__(
        self, *, matcher: Callable[[Event], bool], entities: Reaction = None, handle_once: bool = False
    ) -> None:
        self._matcher = matcher
        self._entities = entities
        self.handle_once = handle_once

    def matches(self, event: Event) -> bool:
        """Return whether the handler matches an event."""
        return self._matcher(event)

    def may_match(self, kind: type[Event]) -> bool:
        """Return whether the handler may match events of a class; True, as a matcher may be any function."""
        return True

    def handle(self, event: Event, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Return the entities to visit because of an event."""
        if self.handle_once:
            context.unregister_event_handler(self)
        return entities_of(self._entities, event, context)


def entities_of(reaction: Reaction, event: Event, context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Return the entities of a reaction to an event.

    Raises:
        TypeError: the reaction is, or returns, something else.
    """
    given = reaction(event, context) if callable(reaction) else reaction
    if given is None:
        return []
    if isinstance(given, LaunchDescriptionEntity):
        return [given]
    if isinstance(given, Iterable):
        found = list(given)
        if all(isinstance(each, LaunchDescriptionEntity) for each in found):
            return found
    raise TypeError(f"an action or a list of actions is wanted as the reaction to an event, not {given!r}")
