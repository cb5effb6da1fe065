"""The cache of a timeline's lanes: aggregates of the past, and painted rows."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from cbtui.looks.theme import Charset, TextRun
from cbtui.text.cells import CellRow
from cbtui.widgets.lanes.columns import I, InstantColumns, LaneColumn, LaneColumns
from cbtui.widgets.lanes.rows import GroupLane, Lane, MemberLane, SoleLane, ThreadLane
from sim.trace.events import EntityId
from sim.trace.model import Blocked, EntityInfo, Position, Span, Wait, Window
from sim.trace.timeline import Timeline


@dataclass(frozen=True, slots=True)
class LaneSummary:
    """A lane's content, column by column.

    ``blocks`` are the columns in which a call waits for a service, ``inside`` those in which it waits for
    anything else, or the program itself waits; ``kept`` are the stretches, by first column and the one after,
    in which a suspended call keeps the group; ``lasting`` are the durations of what was not over yet, in
    words; ``unseen`` are the columns that are not aggregated yet.
    """

    calls: list[LaneColumn[Span] | None]
    waits: list[LaneColumn[Wait] | None]
    blocks: list[LaneColumn[Blocked] | None]
    inside: list[LaneColumn[Position] | None]
    losses: list[int]
    kept: list[tuple[int, int, EntityId]]
    lasting: tuple[str, ...]
    unseen: tuple[int, ...]


@dataclass
class LaneCache:
    """The cache for one timeline: ``painted`` are lanes with what they show, the others rows with a key."""

    timeline: Timeline
    painted: dict[Lane, tuple[LaneSummary, list[TextRun]]] = field(default_factory=dict)
    inside: dict[Lane, tuple[object, list[list[TextRun]]]] = field(default_factory=dict)
    overview: tuple[object, CellRow] = (None, CellRow(0, Charset.BRAILLE))
    _columns: dict[tuple[str, int], LaneColumns[Any]] = field(default_factory=dict)
    _losses: dict[EntityId, InstantColumns] = field(default_factory=dict)

    def spans(self, lane: ThreadLane | GroupLane | MemberLane | SoleLane) -> LaneColumns[Span]:
        """Return the aggregated calls of a lane."""
        match lane:
            case ThreadLane(thread):
                return self.columns(self.timeline.spans_on, thread.id)
            case GroupLane(group):
                return self.columns(self.timeline.spans_in, group.id)
            case MemberLane(entity) | SoleLane(entity):
                return self.columns(self.timeline.spans_of, entity.id)

    def columns(self, query: Callable[[int, Window], Sequence[I]], subject: int) -> LaneColumns[I]:
        """Return the cached columns of a query of the timeline for an id."""
        key = (query.__name__, subject)
        if key not in self._columns:
            self._columns[key] = LaneColumns(partial(query, subject))
        return self._columns[key]

    def losses(self, entity: EntityInfo) -> InstantColumns:
        """Return when the queue of a callback lost messages."""
        if entity.id not in self._losses:
            self._losses[entity.id] = InstantColumns(partial(self.timeline.losses_of, entity.id))
        return self._losses[entity.id]
