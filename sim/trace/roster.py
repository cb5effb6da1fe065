"""The callbacks of a run by group, up to a number that can be shown; the others are counted."""

from collections import Counter
from collections.abc import Iterator
from itertools import islice
from weakref import WeakKeyDictionary

from sim.trace.events import EntityId, EntityKind, GroupId
from sim.trace.model import EntityInfo, GroupInfo
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
"""Last names of the topics and services that every node has; they get no lanes."""

MOST_LANES = 100
"""The number of lanes that can be shown, more than a terminal has rows: a node that creates timers endlessly
must not slow the display down."""


class Roster:
    """Groups with their members, up to ``MOST_LANES``, and source places; grows with its timeline."""

    def __init__(self) -> None:
        self.lanes = 0
        """The number of lanes of all callbacks: one each, and one more for a group of several."""
        self.services: set[str] = set()
        """The names of the services that the run itself offers."""
        self.places: dict[tuple[str, int], EntityId] = {}
        """The first entity of each place in the source: several may share a callback."""
        self.labels: Counter[str] = Counter()
        """How many callbacks have a label."""
        self.functions: set[str] = set()
        """The names of the functions of callbacks other than services."""
        self._sizes: dict[GroupId, int] = {}
        self._members: dict[GroupId, list[EntityInfo]] = {}
        self._seen = 0

    @property
    def groups(self) -> int:
        """How many groups have a member."""
        return len(self._sizes)

    def size(self, group: GroupId) -> int:
        """How many members a group has."""
        return self._sizes.get(group, 0)

    def staged(self, timeline: Timeline) -> Iterator[tuple[GroupInfo, list[EntityInfo]]]:
        """The groups with their members, in order, up to ``MOST_LANES`` lanes."""
        left = MOST_LANES
        for group in timeline.groups.values():
            members = self._members.get(group.id)
            if members:
                yield group, members[:left]
                left -= len(members) + (len(members) > 1)
                if left <= 0:
                    return

    def renewed(self, timeline: Timeline) -> "Roster":
        """Add the entities that have appeared since, and return itself."""
        if len(timeline.entities) != self._seen:
            for entity in islice(timeline.entities.values(), self._seen, None):
                self.places.setdefault((entity.file, entity.first_line), entity.id)
                if entity.label not in HOUSEKEEPING:
                    self._add(entity)
            self._seen = len(timeline.entities)
        return self

    def _add(self, entity: EntityInfo) -> None:
        size = self._sizes.get(entity.group, 0)
        self._sizes[entity.group] = size + 1
        self.lanes += 2 if size == 1 else 1
        self.labels[entity.label] += 1
        if entity.kind is EntityKind.SERVICE:
            self.services.add(entity.name)
        else:
            self.functions.add(entity.callback)
        if size < MOST_LANES:
            self._members.setdefault(entity.group, []).append(entity)


_rosters: WeakKeyDictionary[Timeline, Roster] = WeakKeyDictionary()


def roster_of(timeline: Timeline) -> Roster:
    """The up-to-date roster of a timeline; call it on the timeline's thread."""
    return _rosters.setdefault(timeline, Roster()).renewed(timeline)
