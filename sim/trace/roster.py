"""The callbacks of a run by their groups, as far as anybody could look at them; the rest is counted."""

from collections.abc import Iterator
from itertools import islice
from weakref import WeakKeyDictionary

from sim.trace.events import EntityId, EntityKind, GroupId
from sim.trace.model import Entity, Group
from sim.trace.timeline import Timeline

HOUSEKEEPING = frozenset(
    (
        "describe_parameters",
        "get_parameter_types",
        "get_parameters",
        "get_type_description",
        "list_parameters",
        "parameter_events",
        "set_parameters",
        "set_parameters_atomically",
    )
)
"""Last names of the topics and services that every node brings along; they have no lanes."""

MOST = 100
"""Lanes of groups and callbacks that are looked at, more than a terminal has rows: a node that makes timers
without end must not make a picture dear."""


class Roster:
    """Groups with their members, the first ``MOST`` lanes of them, and places; grows with its timeline."""

    def __init__(self) -> None:
        self.lanes = 0
        """How many lanes all of them would have: one a callback, and one more for a group of several."""
        self.services: set[str] = set()
        """The names of the services that the run itself offers."""
        self.places: dict[tuple[str, int], EntityId] = {}
        """The first entity for each place in the source: many may share a callback."""
        self._sizes: dict[GroupId, int] = {}
        self._members: dict[GroupId, list[Entity]] = {}
        self._seen = 0

    @property
    def groups(self) -> int:
        """How many groups have a member."""
        return len(self._sizes)

    def size(self, group: GroupId) -> int:
        """How many members a group has."""
        return self._sizes.get(group, 0)

    def staged(self, timeline: Timeline) -> Iterator[tuple[Group, list[Entity]]]:
        """The groups that have members, with these, in order, until they would have ``MOST`` lanes."""
        left = MOST
        for group in timeline.groups.values():
            members = self._members.get(group.id)
            if members:
                yield group, members[:left]
                left -= len(members) + (len(members) > 1)
                if left <= 0:
                    return

    def renewed(self, timeline: Timeline) -> "Roster":
        """Take in the entities that have come."""
        if len(timeline.entities) != self._seen:
            for entity in islice(timeline.entities.values(), self._seen, None):
                self.places.setdefault((entity.file, entity.first_line), entity.id)
                if entity.label not in HOUSEKEEPING:
                    self._add(entity)
            self._seen = len(timeline.entities)
        return self

    def _add(self, entity: Entity) -> None:
        size = self._sizes.get(entity.group, 0)
        self._sizes[entity.group] = size + 1
        self.lanes += 2 if size == 1 else 1
        if entity.kind is EntityKind.SERVICE:
            self.services.add(entity.name)
        if size < MOST:
            self._members.setdefault(entity.group, []).append(entity)


_rosters: WeakKeyDictionary[Timeline, Roster] = WeakKeyDictionary()


def roster_of(timeline: Timeline) -> Roster:
    """The roster of a timeline as it is known now. Of the thread that owns the timeline."""
    return _rosters.setdefault(timeline, Roster()).renewed(timeline)
