"""The entities that were active recently."""

from collections.abc import Iterator

from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityId
from sim.trace.model import Nanoseconds

_LATE: Nanoseconds = SECOND
"""How late an event may arrive, in nanoseconds."""


class Activity:
    """The time at which each entity was last active, in that order.

    A run may have thousands of entities, few of them active: those are found without a scan of all.
    """

    def __init__(self) -> None:
        self._latest: dict[EntityId, Nanoseconds] = {}

    def note(self, entity: EntityId, at: Nanoseconds) -> None:
        """Note that an entity was active."""
        self._latest[entity] = max(at, self._latest.pop(entity, at))

    def since(self, at: Nanoseconds) -> Iterator[EntityId]:
        """The entities that were active at ``at`` or later."""
        for entity, latest in reversed(self._latest.items()):
            if latest >= at:
                yield entity
            elif latest < at - _LATE:
                return
