"""The entities that were active recently."""

from collections.abc import Iterator

from sim.trace.events import EntityId
from sim.trace.model import Nanoseconds
from sim.units import SECOND

_LATE: Nanoseconds = SECOND
"""How much later than others an event may be told of."""


class Activity:
    """When each entity was last active, in that order.

    A run may have thousands of entities, few of them active: this finds those without looking at the others.
    """

    def __init__(self) -> None:
        self._latest: dict[EntityId, Nanoseconds] = {}

    def note(self, entity: EntityId, at: Nanoseconds) -> None:
        """An entity was active."""
        self._latest[entity] = max(at, self._latest.pop(entity, at))

    def since(self, at: Nanoseconds) -> Iterator[EntityId]:
        """The entities that were active at ``at`` or later."""
        for entity, latest in reversed(self._latest.items()):
            if latest >= at:
                yield entity
            elif latest < at - _LATE:
                return
