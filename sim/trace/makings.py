"""The entities that callbacks make."""

from collections.abc import Iterable
from typing import NamedTuple

from sim.trace.events import EntityId, EntityKind
from sim.trace.model import EntityInfo, Nanoseconds, Span


class Making(NamedTuple):
    """A line of the program at which a callback, or what it calls, makes entities of a kind."""

    maker: EntityId
    kind: EntityKind
    file: str
    line: int


class Makings:
    """The entities that callbacks made, by line, unless one of the line was destroyed or cancelled."""

    def __init__(self) -> None:
        self.kept: dict[Making, dict[EntityId, Nanoseconds]] = {}
        """When the calls began that made the entities of each line."""
        self._making_of: dict[EntityId, Making] = {}
        self._released: set[Making] = set()

    def note(
        self, entity: EntityInfo, running: Iterable[Span], callbacks: dict[EntityId, EntityInfo]
    ) -> None:
        """Note a new entity, and the calls that run on the threads just now.

        Of several it is made by the one whose code has the line; it is left out if that is unknown.
        """
        calls = list(running)
        file, line = entity.made_at
        if len(calls) > 1:
            calls = [each for each in calls if _contains(callbacks.get(each.entity), file, line)]
        if len(calls) == 1 and file:
            making = self._making_of[entity.id] = Making(calls[0].entity, entity.kind, file, line)
            if making not in self._released:
                self.kept.setdefault(making, {})[entity.id] = calls[0].start

    def release(self, entity: EntityId) -> None:
        """Note that an entity was destroyed or cancelled."""
        making = self._making_of.get(entity)
        if making is not None:
            self._released.add(making)
            self.kept.pop(making, None)


def _contains(callback: EntityInfo | None, file: str, line: int) -> bool:
    return (
        callback is not None and callback.file == file and callback.first_line <= line <= callback.last_line
    )
