"""Which entities did something lately."""

from collections.abc import Iterator

from sim.trace.events import EntityId
from sim.trace.model import Nanoseconds

_LATE: Nanoseconds = 1_000_000_000
"""How much later than others an event may be told of."""


class Activity:
    """When each entity last did anything, those at the end that did it last.

    A run may have thousands of entities of which a few do something: this finds them without asking the rest.
    """

    def __init__(self) -> None:
        self._latest: dict[EntityId, Nanoseconds] = {}

    def note(self, entity: EntityId, at: Nanoseconds) -> None:
        """An entity did something."""
        self._latest[entity] = max(at, self._latest.pop(entity, at))

    def since(self, at: Nanoseconds) -> Iterator[EntityId]:
        """The entities that did something at ``at`` or later."""
        for entity, latest in reversed(self._latest.items()):
            if latest >= at:
                yield entity
            elif latest < at - _LATE:
                return
