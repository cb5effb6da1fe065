"""Paints lanes as rows of text in inks; needs no terminal, so that a picture can be tested as text."""

from collections.abc import Iterator, Mapping, Sequence
from math import inf
from operator import attrgetter

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun
from cbtui.text.cells import CellRow, fit
from cbtui.widgets.lanes.axis import draw_axis
from cbtui.widgets.lanes.bars import BarPainter
from cbtui.widgets.lanes.cache import LaneCache, LaneSummary
from cbtui.widgets.lanes.columns import I, IntervalBudget, LaneColumn, LaneColumns, latest, nested_stretches
from cbtui.widgets.lanes.keys import USUAL_KEYS
from cbtui.widgets.lanes.labels import LaneLabels
from cbtui.widgets.lanes.names import more_lanes
from cbtui.widgets.lanes.picture import LEAST_WIDTH, LaneLayout, LanePicture, layout_for
from cbtui.widgets.lanes.room import ROOMY_FROM, has_overview, rows_granted
from cbtui.widgets.lanes.rows import (
    NONE_KEPT,
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
from cbtui.widgets.lanes.scale import TimeScale, scale_for, whole_scale
from cbtui.widgets.lanes.selection import Selection
from cbtui.widgets.lanes.service_calls import LatestCalls, draw_calls, marked_columns
from cbtui.widgets.lanes.status import LaneStatus
from sim.quantities.durations import duration
from sim.trace.events import EntityId, EntityKind, ThreadId
from sim.trace.figures.chains import ChainStep
from sim.trace.model import Blocked, Moment, Nanoseconds, Position, Span, ThreadInfo, Wait, Window
from sim.trace.timeline import Timeline

FAINT = Ink(Role.FAINT)
PLAIN = Ink(Role.TEXT)
NOW = Ink(Role.NOW)
MARK = Ink(Role.MARK)

INTERVALS_PER_FRAME = 1000
"""Intervals that are examined per frame: a lesson's lanes are complete after one or two frames, at any speed
in each; an hour zoomed out after some thirty, with its overview, and keys stay responsive.
"""

_MOST_NESTED = 100
"""Calls that are examined for nested ones, per stretch."""


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
        threads_last: bool = False,
    ) -> None:
        self.charset, self.service = charset, service
        self.call_key, self.more_key = call_key, more_key
        self.looks, self.threads_last = looks, threads_last
        self.cache = LaneCache(Timeline())

    def paint(
        self,
        timeline: Timeline,
        window: Window,
        now: Nanoseconds,
        width: int,
        height: int,
        selection: Selection | None = None,
        whole: Nanoseconds = 0,
        path: Sequence[ChainStep] = (),
        told: Nanoseconds | None = None,
        kept: Mapping[EntityId, int] = NONE_KEPT,
        kept_thread: ThreadId | None = None,
        end: Nanoseconds | None = None,
    ) -> LanePicture:
        """Paint the lanes of a window, with the cursor at ``now``, in ``width`` x ``height`` cells.

        Words and figures are of the moment ``told``, ``now`` unless given. With ``whole`` there is an
        overview, up to that end; else only where it takes no room. ``path`` stands out on its lanes; those of
        the callbacks ``kept`` and the thread ``kept_thread`` stay longest. The run is drawn up to ``end``.
        """
        if timeline is not self.cache.timeline:
            self.cache = LaneCache(timeline)
        layout = layout_for(max(width, LEAST_WIDTH))
        scale = scale_for(window, layout.columns)
        every = all_lanes(timeline, self.service)
        every.sort(key=lambda lane: self.threads_last and isinstance(lane, ThreadLane))
        if width < LEAST_WIDTH:
            return LanePicture(((TextRun(" " * width, PLAIN),),) * height, (), layout, scale)
        room = height - 1 - (whole > 0)
        chosen = None if selection is None else selection.lane
        lanes = choose_lanes(every, room, timeline, scale.window, chosen, kept, kept_thread)
        moment = timeline.moment(now if told is None else told)
        known = timeline.end if end is None else end
        frame = _LaneFrame(self, timeline, scale, layout, now, moment, selection, path, known, lanes)
        rows, shown = [], list[Lane]()
        more = rows_granted(lanes, timeline, room - len(lanes) if width >= ROOMY_FROM else 0)
        for lane in lanes if height > 0 else ():
            rows.append(frame.lane(lane))
            if isinstance(lane, ThreadLane) and more[lane]:
                rows += frame.inside(lane, more[lane])
            shown += [lane] * (len(rows) - len(shown))
        if height > 0:
            hidden = len(every) - len(lanes) + lanes_beyond(every, timeline)
            rows.append(frame.axis(hidden))
        overview = None
        if height > len(rows) and (whole or has_overview(timeline, width, window)):
            overview = whole_scale(max(timeline.end, window.end, whole), layout.columns)
            rows.append(frame.overview(overview))
        complete = not frame.is_behind
        return LanePicture(tuple(tuple(row) for row in rows), tuple(shown), layout, scale, complete, overview)


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
        path: Sequence[ChainStep],
        end: Nanoseconds,
        lanes: Sequence[Lane],
    ) -> None:
        self._painter = painter
        self._cache = painter.cache
        self._path = path
        self._selection = selection
        self._timeline = timeline
        self._scale = scale
        self._layout = layout
        self._now = now
        self._told = moment.at
        self._ration = IntervalBudget(painter.looks)
        self.is_behind = False
        self._charset = painter.charset
        self._glyphs = GLYPHS[painter.charset]
        self._edge = max(now, end) if timeline.ended is None else end
        self._calls = LatestCalls(timeline)
        self._labels = LaneLabels(timeline, layout.names, self._glyphs, lanes)
        self._bars = BarPainter(timeline, self._glyphs, now, self._told, self._edge)
        self._status = LaneStatus(timeline, scale.window, moment, self._calls, self._charset, layout.statuses)

    def lane(self, lane: Lane) -> list[TextRun]:
        """Paint a lane with its name and status."""
        sums = self._sums(lane)
        chosen = self._selection is not None and self._selection.lane == lane
        fresh = chosen or any(self._steps(lane)) or not self._repeats(lane)
        runs = self._painted(lane, sums) if fresh else self._kept(lane, sums)
        status = self._status.of(lane, latest(sums.calls, self._column_at(self._told)))
        return self._framed(self._labels.of(lane), runs, status, chosen)

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

    def _kept(self, lane: Lane, sums: LaneSummary) -> list[TextRun]:
        """Return a lane's cached row, painted again if the lane has changed."""
        before = self._cache.painted.get(lane)
        if before is not None and before[0] == sums:
            return before[1]
        runs = self._painted(lane, sums)
        self._cache.painted[lane] = (sums, runs)
        return runs

    def _painted(self, lane: Lane, sums: LaneSummary) -> list[TextRun]:
        row = CellRow(self._layout.columns, self._charset)
        self._draw(row, lane, sums)
        for place in sums.unseen:
            row.put(place, self._glyphs.point, FAINT)
        selection = self._selection
        if selection is not None and selection.lane == lane and selection.bar is not None:
            self._bars.select(row, selection.bar, self._scale)
        for number, step in self._steps(lane):
            self._bars.mark_step(row, number, step, self._scale)
        self._show_cursor(row)
        return row.runs()

    def _steps(self, lane: Lane) -> list[tuple[int, ChainStep]]:
        """The steps of the path on a lane that took time, each with its number on the whole path."""
        if not isinstance(lane, MemberLane | SoleLane):
            return []
        shown = self._scale.window
        steps = enumerate((step for step in self._path if step.entity and step.length), start=1)
        return [
            (number, step)
            for number, step in steps
            if step.entity == lane.entity.id and step.start < shown.end and step.end >= shown.start
        ]

    def inside(self, lane: ThreadLane, rows: int) -> list[list[TextRun]]:
        """Paint the lines at which the calls of a thread are, and the calls inside them, in one row or two.

        While the run is followed this is painted once a column: it is read more slowly than bars move.
        """
        key = (self._scale, self._scale.column_of(self._edge), rows) if self._now >= self._edge else None
        kept_key, painted = self._cache.inside.get(lane, (None, []))
        if key is None or key != kept_key:
            unseen: set[int] = set()
            painted = self._painted_inside(lane, rows, unseen)
            self._cache.inside[lane] = (None if self.is_behind else key, painted)
        nothing = TextRun("", PLAIN)
        return [self._framed([nothing], runs, nothing, chosen=False) for runs in painted]

    def _painted_inside(self, lane: ThreadLane, count: int, unseen: set[int]) -> list[list[TextRun]]:
        rows = [CellRow(self._layout.columns, self._charset) for _ in range(count)]
        columns = self._cache.columns(self._timeline.positions_on, lane.thread.id)
        calls = self._summed(self._cache.spans(lane), unseen)
        if not unseen:  # the first rows are dropped first
            nested = [
                each for stretch in nested_stretches(calls) for each in self._nested(lane.thread, *stretch)
            ]
            self._bars.nested(rows[-1], nested)
            self._bars.inside(rows[0], self._summed(columns, unseen))
        for row in rows:
            self._show_cursor(row)
        return [row.runs() for row in rows]

    def _nested(self, thread: ThreadInfo, first: int, after: int) -> Iterator[tuple[int, int, Span]]:
        """Yield the calls inside others between two columns, with their own columns."""
        scale = self._scale
        window = Window(scale.time_at(first), scale.time_at(after))
        outer = 0
        for span in self._timeline.spans_on(thread.id, window)[:_MOST_NESTED]:
            end = span.end_at(self._edge)
            if span.start < outer:
                begins = max(first, scale.column_of(span.start))
                yield begins, min(after, max(begins, scale.column_of(end - 1)) + 1), span
            outer = max(outer, end)

    def overview(self, scale: TimeScale) -> list[TextRun]:
        """Paint how busy the threads were in the whole run, and which part of it is on screen."""
        shown = self._scale.window
        first, last = scale.column_of(max(0, shown.start)), scale.column_of(shown.end - 1)
        key = (scale, scale.column_of(self._edge))
        if key != self._cache.overview[0]:
            unseen: set[int] = set()
            busy = self._busy_threads(scale, unseen)
            self._cache.overview = (None if self.is_behind else key, busy)
        row = self._cache.overview[1].copy()
        row.put(scale.column_of(self._now), self._glyphs.cursor, NOW)
        later = {ink: ink._replace(later=True) for ink in {*row.inks}}
        row.inks = [ink if first <= place <= last else later[ink] for place, ink in enumerate(row.inks)]
        name, unit = TextRun("whole run", FAINT), TextRun(f"{duration(scale.per_column)}/col", FAINT)
        return self._framed([name], row.runs(), unit, chosen=False)

    def _busy_threads(self, scale: TimeScale, unseen: set[int]) -> CellRow:
        row = CellRow(self._layout.columns, self._charset)
        threads = list(self._timeline.threads)
        lanes = [
            self._summed(self._cache.columns(self._timeline.spans_on, thread), unseen, scale)
            for thread in threads
        ]
        for place, columns in enumerate(zip(*lanes, strict=True)):
            busy = [column for column in columns if column is not None]
            if busy:
                top = max(busy, key=attrgetter("eighths")).top
                height = -(-sum(column.eighths for column in busy) // len(threads))
                number = self._timeline.groups[self._timeline.entities[top.entity].group].place
                row.put(place, self._glyphs.heights[min(8, height)], Ink(Role.LINE, number))
        return row

    def axis(self, hidden: int) -> list[TextRun]:
        """Paint the time axis, with the number of hidden lanes at its left."""
        row = CellRow(self._layout.columns, self._charset)
        marks = self._timeline.marks(self._scale.window)
        column = self._column_at(self._now)
        newest = "now" if self._timeline.ended is None else "end"
        cursor = "cursor" if self._now < self._edge else newest
        draw_axis(row, self._scale, column, cursor, marks, self._calls.latest)
        name = more_lanes(hidden, self._painter.more_key, self._layout.names) if hidden else "seconds"
        unit = f"{duration(self._scale.per_column)}/col" if self._layout.statuses >= 15 else ""
        self._show_cursor(row)
        return self._framed([TextRun(name, FAINT)], row.runs(), TextRun(unit, FAINT), chosen=False)

    def _column_at(self, moment: Nanoseconds) -> int:
        """The column of a moment; the last one when the picture ends exactly there."""
        return self._scale.column_of(moment - (moment == self._scale.window.end))

    def _sums(self, lane: Lane) -> LaneSummary:
        cache, timeline = self._cache, self._timeline
        unseen: set[int] = set()
        calls = [] if isinstance(lane, ServiceLane) else self._summed(cache.spans(lane), unseen)
        waits: list[LaneColumn[Wait] | None] = []
        blocks: list[LaneColumn[Blocked] | None] = []
        inside: list[LaneColumn[Position] | None] = []
        losses: list[int] = []
        kept = self._bars.kept_columns(lane.group, self._scale) if isinstance(lane, GroupLane) else []
        match lane:
            case ThreadLane(thread):
                blocks = self._summed(cache.columns(timeline.blocks_on, thread.id), unseen)
                lines = self._summed(cache.columns(timeline.positions_on, thread.id), unseen)
                own = self._summed(cache.columns(timeline.program_waits_on, thread.id), unseen)
                inside = [
                    at if at and at.top.waits and block is None else program
                    for at, program, block in zip(lines, own, blocks, strict=True)
                ]
            case MemberLane(entity) | SoleLane(entity):
                waits = self._bars.judged(self._summed(cache.columns(timeline.waits_of, entity.id), unseen))
                losses = cache.losses(entity).over(self._scale, self._edge)
        lasting = dict.fromkeys(
            column.top.start
            for columns in (calls, waits)
            for column in columns
            if column is not None and (column.top.end is None or column.top.end > self._told)
        )
        lengths = tuple(duration(max(0, self._told - start)) for start in lasting)
        return LaneSummary(calls, waits, blocks, inside, losses, kept, lengths, tuple(sorted(unseen)))

    def _summed(
        self, columns: LaneColumns[I], unseen: set[int], scale: TimeScale | None = None
    ) -> list[LaneColumn[I] | None]:
        """Aggregate within the picture's budget, and add the remaining columns to ``unseen``."""
        summed = columns.over(scale or self._scale, self._edge, self._ration)
        unseen.update(columns.unseen)
        self.is_behind = self.is_behind or columns.is_behind
        return summed

    def _draw(self, row: CellRow, lane: Lane, sums: LaneSummary) -> None:
        match lane:
            case ThreadLane():
                self._bars.thread(row, sums.calls)
                self._bars.blocked(row, sums.blocks)
                self._bars.waiting(row, sums.inside)
            case GroupLane(group):
                self._bars.group(row, sums.calls, group)
                self._bars.kept(row, sums.kept, group)
            case MemberLane(entity) | SoleLane(entity):
                calls = self._calls.of(entity.name) if entity.kind is EntityKind.SERVICE else ()
                key = self._key_of(entity.name)
                marks = marked_columns(calls, self._scale, key)
                self._bars.calls(row, sums.calls, entity, marks)
                self._bars.waits(row, sums.waits, sums.calls, marks)
                self._bars.late(row, sums.calls, entity)
                self._bars.lost(row, sums.losses)
                draw_calls(row, calls, self._scale, self._edge, key)
            case ServiceLane(service):
                key = self._key_of(service)
                draw_calls(row, self._calls.of(service), self._scale, self._edge, key)

    def _key_of(self, service: str) -> str:
        """The key that calls a service; "" if no key does."""
        return self._painter.call_key if self._painter.service in ("", service) else ""

    def _framed(
        self, name: list[TextRun], runs: list[TextRun], status: TextRun, chosen: bool
    ) -> list[TextRun]:
        *before, last = name
        room = self._labels.room_after(before)
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
        column = self._column_at(self._now)
        at_edge = self._now + self._scale.per_column >= self._edge
        if at_edge or not 0 <= column < len(row.cells):
            return
        if row.blank(column, column + 1):
            row.put(column, self._glyphs.cursor, NOW)
        row.inks[column + 1 :] = [ink._replace(later=True) for ink in row.inks[column + 1 :]]
