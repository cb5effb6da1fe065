"""Paints lanes as rows of text in inks; needs no terminal, so that a picture can be tested as text."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf
from typing import Any

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun, texture_of
from cbtui.text.cells import CellRow, fit
from cbtui.widgets.lanes.axis import draw_axis
from cbtui.widgets.lanes.bars import BarPainter
from cbtui.widgets.lanes.columns import I, InstantColumns, IntervalBudget, LaneColumn, LaneColumns
from cbtui.widgets.lanes.keys import USUAL_KEYS
from cbtui.widgets.lanes.names import entity_name, group_name, more_lanes, sole_name, thread_name
from cbtui.widgets.lanes.picture import LEAST_WIDTH, LaneLayout, LanePicture, layout_for
from cbtui.widgets.lanes.rows import (
    GroupLane,
    Lane,
    MemberLane,
    ServiceLane,
    SoleLane,
    ThreadLane,
    all_lanes,
    choose_lanes,
    lanes_beyond,
)
from cbtui.widgets.lanes.scale import TimeScale, scale_for
from cbtui.widgets.lanes.selection import Selection
from cbtui.widgets.lanes.service_calls import LatestCalls, draw_calls
from cbtui.widgets.lanes.status import LaneStatus
from sim.durations import duration
from sim.trace.events import EntityId, EntityKind
from sim.trace.model import AxisMark, Blocked, EntityInfo, GroupInfo, Moment, Nanoseconds, Span, Wait, Window
from sim.trace.timeline import Timeline

FAINT = Ink(Role.FAINT)
PLAIN = Ink(Role.TEXT)
NOW = Ink(Role.NOW)
MARK = Ink(Role.MARK)


INTERVALS_PER_FRAME = 500
"""Intervals that are examined per frame: a lesson's lanes are complete after two or three frames, an hour
zoomed out after some twenty, and keys stay responsive.
"""

_TEXTURED_FROM = 20
"""The smallest width of the names' column that shows the textures of groups."""
_SWATCH = 2
"""Columns of texture beside a group's letter."""


def wanted_rows(timeline: Timeline, service: str = "") -> int:
    """Return the number of rows that show every lane and the axis; ``service`` as for the painter."""
    return len(all_lanes(timeline, service)) + 1


class LanePainter:
    """Paints a timeline as lanes. One painter serves one widget: it caches aggregates of the past.

    ``service`` is another program's service that gets a lane before its first call. ``looks`` limits the
    intervals that are examined per picture; the next picture of the same window goes on from there.
    ``call_key`` is the key that calls the service, as people write it, ``more_key`` the one that shows hidden
    lanes; "" if there is none.
    """

    def __init__(
        self,
        charset: Charset = Charset.BRAILLE,
        service: str = "",
        looks: float = inf,
        call_key: str = USUAL_KEYS.call,
        more_key: str = "",
    ) -> None:
        self.charset = charset
        self.call_key = call_key
        self.more_key = more_key
        self.service = service
        self.looks = looks
        self._timeline: Timeline | None = None
        self._columns: dict[tuple[str, int], LaneColumns[Any]] = {}
        self._losses: dict[EntityId, InstantColumns] = {}
        self.painted: dict[Lane, tuple[_LaneSummary, list[TextRun]]] = {}

    def paint(
        self,
        timeline: Timeline,
        window: Window,
        now: Nanoseconds,
        width: int,
        height: int,
        selection: Selection | None = None,
    ) -> LanePicture:
        """Paint the lanes of a window, with the cursor at ``now``, in ``width`` x ``height`` cells."""
        if timeline is not self._timeline:
            self._timeline = timeline
            self._columns.clear()
            self._losses.clear()
            self.painted.clear()
        layout = layout_for(max(width, LEAST_WIDTH))
        scale = scale_for(window, layout.columns)
        every = all_lanes(timeline, self.service)
        if width < LEAST_WIDTH:
            return LanePicture(((TextRun(" " * width, PLAIN),),) * height, (), layout, scale)
        lanes = choose_lanes(
            every, height - 1, timeline, scale.window, None if selection is None else selection.lane
        )
        frame = _LaneFrame(self, timeline, scale, layout, now, timeline.moment(now), selection)
        rows = [frame.lane(lane) for lane in lanes] if height > 0 else []
        if height > 0:
            hidden = len(every) - len(lanes) + lanes_beyond(every, timeline)
            rows.append(frame.axis(hidden))
        complete = not frame.unseen
        return LanePicture(tuple(tuple(row) for row in rows), tuple(lanes), layout, scale, complete)

    def spans(self, lane: Lane, timeline: Timeline) -> LaneColumns[Span]:
        """Return the aggregated calls of a lane."""
        match lane:
            case ThreadLane(thread):
                return self.columns(timeline.spans_on, thread.id)
            case GroupLane(group):
                return self.columns(timeline.spans_in, group.id)
            case MemberLane(entity) | SoleLane(entity):
                return self.columns(timeline.spans_of, entity.id)
            case ServiceLane():
                return LaneColumns(lambda _: ())

    def columns(self, query: Callable[[int, Window], Sequence[I]], subject: int) -> LaneColumns[I]:
        """Return the cached columns of a query of the timeline for an id."""
        key = (query.__name__, subject)
        if key not in self._columns:
            self._columns[key] = LaneColumns(partial(query, subject))
        return self._columns[key]

    def losses(self, entity: EntityInfo, timeline: Timeline) -> InstantColumns:
        """Return when the queue of a callback lost messages."""
        if entity.id not in self._losses:
            self._losses[entity.id] = InstantColumns(partial(timeline.losses_of, entity.id))
        return self._losses[entity.id]


@dataclass(frozen=True, slots=True)
class _LaneSummary:
    """A lane's content, column by column.

    ``lasting`` is the duration of the open interval, in words; ``unseen`` are the columns that are not
    aggregated yet.
    """

    scale: TimeScale
    calls: list[LaneColumn[Span] | None]
    waits: list[LaneColumn[Wait] | None]
    blocks: list[LaneColumn[Blocked] | None]
    losses: list[int]
    lasting: tuple[str, ...]
    unseen: tuple[int, ...]


class _LaneFrame:
    """One picture while it is painted."""

    def __init__(
        self,
        painter: LanePainter,
        timeline: Timeline,
        scale: TimeScale,
        layout: LaneLayout,
        now: Nanoseconds,
        moment: Moment,
        selection: Selection | None,
    ) -> None:
        self._painter = painter
        self._selection = selection
        self._timeline = timeline
        self._scale = scale
        self._layout = layout
        self._now = now
        self._ration = IntervalBudget(painter.looks)
        self.unseen = False
        self._charset = painter.charset
        self._glyphs = GLYPHS[painter.charset]
        self._edge = max(now, timeline.end) if timeline.ended is None else timeline.end
        self._calls = LatestCalls(timeline)
        self._numbers = {group: place for place, group in enumerate(timeline.groups)}
        self._bars = BarPainter(timeline, self._glyphs, now, self._numbers)
        self._status = LaneStatus(timeline, scale.window, moment, self._calls, self._charset, layout.statuses)

    def lane(self, lane: Lane) -> list[TextRun]:
        """Paint a lane with its name and status."""
        sums = self._sums(lane)
        chosen = self._selection is not None and self._selection.lane == lane
        runs = self._painted(lane, sums) if chosen or not self._repeats(lane) else self._kept(lane, sums)
        return self._framed(self._name(lane), runs, self._status.of(lane, self._latest(sums.calls)), chosen)

    def _repeats(self, lane: Lane) -> bool:
        """Whether a lane looks the same as long as its aggregates do."""
        if self._now < self._edge:
            return False
        match lane:
            case ServiceLane():
                return False
            case MemberLane(entity) | SoleLane(entity):
                return entity.kind is not EntityKind.SERVICE
        return True

    def _kept(self, lane: Lane, sums: _LaneSummary) -> list[TextRun]:
        """Return a lane's cached row, painted again if the lane has changed."""
        before = self._painter.painted.get(lane)
        if before is not None and before[0] == sums:
            return before[1]
        runs = self._painted(lane, sums)
        self._painter.painted[lane] = (sums, runs)
        return runs

    def _painted(self, lane: Lane, sums: _LaneSummary) -> list[TextRun]:
        row = CellRow(self._layout.columns, self._charset)
        self._draw(row, lane, sums)
        for place in sums.unseen:
            row.put(place, self._glyphs.point, FAINT)
        selection = self._selection
        if selection is not None and selection.lane == lane and selection.bar is not None:
            self._bars.select(row, selection.bar, self._scale)
        self._show_cursor(row)
        return row.runs()

    def axis(self, hidden: int) -> list[TextRun]:
        """Paint the time axis, with the number of hidden lanes at its left."""
        row = CellRow(self._layout.columns, self._charset)
        draw_axis(row, self._scale, self._now_column, self._commands())
        name = more_lanes(hidden, self._painter.more_key, self._layout.names) if hidden else "seconds"
        unit = f"{duration(self._scale.per_column)}/col" if self._layout.statuses >= 15 else ""
        self._show_cursor(row)
        return self._framed([TextRun(name, FAINT)], row.runs(), TextRun(unit, FAINT), chosen=False)

    @property
    def _now_column(self) -> int:
        """The cursor's column; the last one when the picture ends exactly there."""
        return self._scale.column_of(self._now - (self._now == self._scale.window.end))

    def _sums(self, lane: Lane) -> _LaneSummary:
        painter, timeline = self._painter, self._timeline
        unseen: set[int] = set()
        calls = self._summed(painter.spans(lane, timeline), unseen)
        waits: list[LaneColumn[Wait] | None] = []
        blocks: list[LaneColumn[Blocked] | None] = []
        losses: list[int] = []
        match lane:
            case ThreadLane(thread):
                blocks = self._summed(painter.columns(timeline.blocks_on, thread.id), unseen)
            case MemberLane(entity) | SoleLane(entity):
                waits = self._summed(painter.columns(timeline.waits_of, entity.id), unseen)
                losses = painter.losses(entity, timeline).over(self._scale, self._edge)
        self.unseen = self.unseen or bool(unseen)
        lasting = dict.fromkeys(
            column.top.start
            for columns in (calls, waits)
            for column in columns
            if column is not None and column.top.end is None
        )
        lengths = tuple(duration(self._now - start) for start in lasting)
        return _LaneSummary(self._scale, calls, waits, blocks, losses, lengths, tuple(sorted(unseen)))

    def _summed(self, columns: LaneColumns[I], unseen: set[int]) -> list[LaneColumn[I] | None]:
        """Aggregate within the picture's budget, and add the remaining columns to ``unseen``."""
        summed = columns.over(self._scale, self._edge, self._ration)
        unseen.update(columns.unseen)
        return summed

    def _draw(self, row: CellRow, lane: Lane, sums: _LaneSummary) -> None:
        match lane:
            case ThreadLane():
                self._bars.thread(row, sums.calls)
                self._bars.blocked(row, sums.blocks)
            case GroupLane(group):
                self._bars.group(row, sums.calls, group)
            case MemberLane(entity) | SoleLane(entity):
                self._bars.calls(row, sums.calls, entity)
                self._bars.waits(row, sums.waits, sums.calls)
                self._bars.lost(row, sums.losses)
                if entity.kind is EntityKind.SERVICE:
                    draw_calls(
                        row, self._calls.of(entity.name), self._scale, self._edge, self._painter.call_key
                    )
            case ServiceLane(service):
                draw_calls(row, self._calls.of(service), self._scale, self._edge, self._painter.call_key)

    def _latest(self, columns: list[LaneColumn[Span] | None]) -> Span | None:
        shown = columns[: max(0, self._now_column + 1)]
        return next((column.top for column in reversed(shown) if column is not None), None)

    def _commands(self) -> list[AxisMark]:
        """The person's commands, except the calls that a service's lane shows."""
        shown = {self._scale.column_of(call.sent) for call in self._calls.latest}
        marks = self._timeline.marks(self._scale.window)
        return [m for m in marks if m.kind == "command" and self._scale.column_of(m.at) not in shown]

    def _framed(
        self, name: list[TextRun], runs: list[TextRun], status: TextRun, chosen: bool
    ) -> list[TextRun]:
        *before, last = name
        room = self._room_after(before)
        frame = TextRun(self._glyphs.frame, FAINT)
        text = f" {status.text}" if self._layout.statuses else ""
        return [
            *before,
            TextRun(fit(last.text, room, self._charset), last.ink),
            TextRun(self._glyphs.forth, MARK) if chosen else frame,
            *runs,
            frame,
            TextRun(fit(text, self._layout.statuses, self._charset), status.ink),
        ]

    def _show_cursor(self, row: CellRow) -> None:
        """Mark the cursor and the time after it, unless it is at the edge."""
        column = self._now_column
        at_edge = self._now + self._scale.per_column >= self._edge
        if at_edge or not 0 <= column < len(row.cells):
            return
        if row.blank(column, column + 1):
            row.put(column, self._glyphs.cursor, NOW)
        row.inks[column + 1 :] = [ink._replace(later=True) for ink in row.inks[column + 1 :]]

    def _name(self, lane: Lane) -> list[TextRun]:
        match lane:
            case ThreadLane(thread):
                name = thread_name(thread, self._layout.names - 1, self._glyphs.ellipsis)
                return [TextRun(name, PLAIN)]
            case GroupLane(group):
                letter = self._letter(group)
                return [*letter, TextRun(group_name(group, self._room_after(letter)), PLAIN)]
            case MemberLane(entity):
                return [TextRun(f"  {entity_name(entity, self._layout.names - 3)}", PLAIN)]
            case SoleLane(entity, group):
                letter = self._letter(group)
                return [*letter, TextRun(sole_name(entity, group, self._room_after(letter)), PLAIN)]
            case ServiceLane(service):
                return [TextRun(service, PLAIN)]

    def _room_after(self, runs: list[TextRun]) -> int:
        """The columns left after a name."""
        return self._layout.names - sum(len(run.text) for run in runs)

    def _letter(self, group: GroupInfo) -> list[TextRun]:
        """A group's letter, and its texture where there is room."""
        number = self._numbers[group.id]
        letter = TextRun(f"{group.letter} ", Ink(Role.LETTER, number))
        if self._layout.names < _TEXTURED_FROM:
            return [letter]
        texture = texture_of(number, self._glyphs)
        return [letter, texture._replace(text=texture.text * _SWATCH), TextRun(" ", PLAIN)]
