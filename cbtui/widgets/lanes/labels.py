"""The labels at the left of lanes: names, and the letters and textures of groups."""

from collections.abc import Sequence
from dataclasses import InitVar, dataclass, field

from cbtui.looks.theme import Glyphs, Ink, Role, TextRun, texture_of
from cbtui.widgets.lanes.names import (
    entity_name,
    group_name,
    service_name,
    sole_name,
    thread_name,
    told_apart,
)
from cbtui.widgets.lanes.rows import GroupLane, Lane, MemberLane, ServiceLane, SoleLane, ThreadLane
from sim.trace.events import GroupId
from sim.trace.model import EntityInfo, GroupInfo
from sim.trace.roster import roster_of
from sim.trace.timeline import Timeline

_PLAIN = Ink(Role.TEXT)
_TEXTURED_FROM = 20
"""The smallest width of the names' column that shows the textures of groups."""
_SWATCH = 2
"""Columns of texture beside a group's letter."""


@dataclass(slots=True)
class LaneLabels:
    """Labels of ``width`` columns, for the lanes shown; groups are coloured by their places."""

    timeline: Timeline
    width: int
    glyphs: Glyphs
    shown: InitVar[Sequence[Lane]]
    _names: list[str] = field(init=False)
    _headed: set[GroupId] = field(init=False)

    def __post_init__(self, shown: Sequence[Lane]) -> None:
        self._headed = {lane.group.id for lane in shown if isinstance(lane, GroupLane)}
        staged = roster_of(self.timeline).staged(self.timeline)
        self._names = [self._name(member) for _, members in staged for member in members]

    def of(self, lane: Lane) -> list[TextRun]:
        """Return a lane's label; its last run may have to be cut."""
        ellipsis = self.glyphs.ellipsis
        match lane:
            case ThreadLane(thread):
                name = thread_name(thread, self.width - 1, ellipsis)
                return [TextRun(name, _PLAIN)]
            case GroupLane(group):
                letter = self._letter(group)
                return [*letter, TextRun(group_name(group, self.room_after(letter)), _PLAIN)]
            case MemberLane(entity, group) if group.id in self._headed:
                name = entity_name(self._name(entity), self.width - 2, ellipsis, self._names)
                return [TextRun(f"  {name}", _PLAIN)]
            case SoleLane(entity, group) | MemberLane(entity, group):
                letter = self._letter(group)
                name = sole_name(self._name(entity), group, self.room_after(letter), ellipsis, self._names)
                return [*letter, TextRun(name, _PLAIN)]
            case ServiceLane(service):
                name = service_name(service, self.width, ellipsis, self.timeline.services_called)
                return [TextRun(name, _PLAIN)]

    def room_after(self, runs: Sequence[TextRun]) -> int:
        """Return the columns that are left after parts of a label."""
        return self.width - sum(len(run.text) for run in runs)

    def _name(self, entity: EntityInfo) -> str:
        return told_apart(entity, self.timeline, self.glyphs.back)

    def _letter(self, group: GroupInfo) -> list[TextRun]:
        """A group's letter, and its texture where there is room."""
        letter = TextRun(f"{group.letter} ", Ink(Role.LETTER, group.place))
        if self.width < _TEXTURED_FROM:
            return [letter]
        texture = texture_of(group.place, self.glyphs)
        return [letter, texture._replace(text=texture.text * _SWATCH), TextRun(" ", _PLAIN)]
