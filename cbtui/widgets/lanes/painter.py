"""Paints lanes as rows of text in inks; needs no terminal, so that a picture can be tested as text."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from cbtui.theme import GLYPHS, Charset, Ink, Role, Run
from cbtui.widgets.cells import Row, fit
from cbtui.widgets.durations import duration
from cbtui.widgets.lanes.bars import Bars, short_thread
from cbtui.widgets.lanes.calls import Calls, draw_calls
from cbtui.widgets.lanes.columns import Column, Columns
from cbtui.widgets.lanes.rows import (
    GroupLane,
    Lane,
    MemberLane,
    ServiceLane,
    SoleLane,
    ThreadLane,
    all_lanes,
    choose,
)
from cbtui.widgets.lanes.scale import Scale, labels, scale_for
from cbtui.widgets.lanes.status import Status, short
from sim.trace.events import EntityKind
from sim.trace.model import Entity, Group, Moment, Nanoseconds, Span, Wait, Window
from sim.trace.timeline import Timeline

FAINT = Ink(Role.FAINT)
PLAIN = Ink(Role.TEXT)
NOW = Ink(Role.NOW)
MARK = Ink(Role.MARK)


LEAST_WIDTH = 20
"""Columns below which lanes are left blank."""


@dataclass(frozen=True, slots=True)
class Layout:
    """How a width is shared out: names at the left, lanes, statuses at the right; a frame between."""

    names: int
    columns: int
    statuses: int


def layout_for(width: int) -> Layout:
    """Share out a width of ``LEAST_WIDTH`` or more: the narrower, the shorter names and statuses."""
    for least, names, statuses in ((120, 23, 25), (72, 12, 16), (48, 10, 10), (LEAST_WIDTH, 6, 0)):
        if width >= least:
            return Layout(names, width - names - statuses - 2, statuses)
    raise ValueError(f"lanes need {LEAST_WIDTH} columns, got {width}")


@dataclass(frozen=True, slots=True)
class Picture:
    """Painted lanes, the axis last. ``lanes`` are those that ``rows`` begins with, one a row."""

    rows: tuple[tuple[Run, ...], ...]
    lanes: tuple[Lane, ...]
    layout: Layout
    scale: Scale

    @property
    def text(self) -> str:
        """The picture without its inks."""
        return "\n".join("".join(run.text for run in row) for row in self.rows)

    @property
    def time_per_column(self) -> str:
        """The scale in words, such as ``200 ms/col``."""
        return f"{duration(self.scale.per_column)}/col"


def wanted_rows(timeline: Timeline, service: str = "") -> int:
    """Return how many rows show every lane of a run and the axis; ``service`` as for the painter."""
    return len(all_lanes(timeline, service)) + 1


class Painter:
    """Paints a timeline as lanes; keeps what it summed up of the past, so that one painter serves one widget.

    ``service`` is a service of others that is to have a lane before it is first called.
    """

    def __init__(self, charset: Charset = Charset.BRAILLE, service: str = "") -> None:
        self.charset = charset
        self.service = service
        self._timeline: Timeline | None = None
        self._spans: dict[tuple[str, int], Columns[Span]] = {}
        self._waits: dict[int, Columns[Wait]] = {}

    def text(self, timeline: Timeline, window: Window, now: Nanoseconds, width: int, height: int) -> str:
        """Return the picture of ``paint`` as plain text."""
        return self.paint(timeline, window, now, width, height).text

    def paint(self, timeline: Timeline, window: Window, now: Nanoseconds, width: int, height: int) -> Picture:
        """Paint the lanes of a window, with the cursor at ``now``, in ``width`` x ``height`` cells."""
        if timeline is not self._timeline:
            self._timeline = timeline
            self._spans.clear()
            self._waits.clear()
        layout = layout_for(max(width, LEAST_WIDTH))
        scale = scale_for(window, layout.columns)
        moment = timeline.moment(now)
        every = all_lanes(timeline, self.service)
        if width < LEAST_WIDTH:
            return Picture(((Run(" " * width, PLAIN),),) * height, (), layout, scale)
        lanes = choose(every, height - 1, timeline, scale.window, moment)
        frame = _Frame(self, timeline, scale, layout, now, moment)
        rows = [frame.lane(lane) for lane in lanes] if height > 0 else []
        if height > 0:
            rows.append(frame.axis(hidden=len(every) - len(lanes)))
        return Picture(tuple(tuple(row) for row in rows), tuple(lanes), layout, scale)

    def spans(self, lane: Lane, timeline: Timeline) -> Columns[Span]:
        """Return the summed-up calls of a lane."""
        match lane:
            case ThreadLane(thread):
                return self._kept(timeline.spans_on, thread.id)
            case GroupLane(group):
                return self._kept(timeline.spans_in, group.id)
            case MemberLane(entity) | SoleLane(entity):
                return self._kept(timeline.spans_of, entity.id)
            case ServiceLane():
                return Columns(lambda _: ())

    def _kept(self, query: Callable[[int, Window], Sequence[Span]], subject: int) -> Columns[Span]:
        key = (query.__name__, subject)
        if key not in self._spans:
            self._spans[key] = Columns(partial(query, subject))
        return self._spans[key]

    def waits(self, entity: Entity, timeline: Timeline) -> Columns[Wait]:
        """Return the summed-up waits of a callback."""
        if entity.id not in self._waits:
            self._waits[entity.id] = Columns(partial(timeline.waits_of, entity.id))
        return self._waits[entity.id]


class _Frame:
    """One picture while it is painted."""

    def __init__(
        self,
        painter: Painter,
        timeline: Timeline,
        scale: Scale,
        layout: Layout,
        now: Nanoseconds,
        moment: Moment,
    ) -> None:
        self._painter = painter
        self._timeline = timeline
        self._scale = scale
        self._layout = layout
        self._now = now
        self._charset = painter.charset
        self._glyphs = GLYPHS[painter.charset]
        self._edge = max(now, timeline.end) if timeline.ended is None else timeline.end
        self._calls = Calls(timeline)
        self._numbers = {group: place for place, group in enumerate(timeline.groups)}
        self._bars = Bars(timeline, self._glyphs, now, self._numbers)
        self._status = Status(timeline, scale.window, moment, self._calls, self._charset, layout.statuses)

    def lane(self, lane: Lane) -> list[Run]:
        """Paint a lane with its name and status."""
        row = Row(self._layout.columns, self._charset)
        columns = self._painter.spans(lane, self._timeline).over(self._scale, self._edge)
        self._draw(row, lane, columns)
        return self._framed(self._name(lane), row, self._status.of(lane, self._latest(columns)))

    def axis(self, hidden: int) -> list[Run]:
        """Paint the time axis; ``hidden`` lanes that had no room are told of at its left."""
        row = Row(self._layout.columns, self._charset)
        self._mark_now(row)
        for column, text in labels(self._scale):
            if row.blank(max(column - 1, 0), column + len(text) + 1):
                row.write(column, text, FAINT)
        self._mark_commands(row)
        name = f"+{hidden} lanes" if hidden else "seconds"
        unit = f"{duration(self._scale.per_column)}/col" if self._layout.statuses >= 15 else ""
        return self._framed([Run(name, FAINT)], row, Run(unit, FAINT))

    @property
    def _now_column(self) -> int:
        """The cursor's column; the last one when the picture ends exactly there."""
        return self._scale.column_of(self._now - (self._now == self._scale.window.end))

    def _draw(self, row: Row, lane: Lane, columns: list[Column[Span] | None]) -> None:
        match lane:
            case ThreadLane():
                self._bars.thread(row, columns)
            case GroupLane(group):
                self._bars.group(row, columns, group)
            case MemberLane(entity) | SoleLane(entity):
                waits = self._painter.waits(entity, self._timeline).over(self._scale, self._edge)
                self._bars.calls(row, columns, entity)
                self._bars.waits(row, waits, columns)
                if entity.kind is EntityKind.SERVICE:
                    draw_calls(row, self._calls.of(entity.name), self._scale, self._edge)
            case ServiceLane(service):
                draw_calls(row, self._calls.of(service), self._scale, self._edge)

    def _latest(self, columns: list[Column[Span] | None]) -> Span | None:
        shown = columns[: max(0, self._now_column + 1)]
        return next((column.top for column in reversed(shown) if column is not None), None)

    def _mark_commands(self, row: Row) -> None:
        """Mark what the person did, but for the calls that a service's lane shows."""
        shown = {self._scale.column_of(call.sent) for call in self._calls.latest}
        for mark in self._timeline.marks(self._scale.window):
            column = self._scale.column_of(mark.at)
            if mark.kind == "command" and column not in shown and row.inks[column] is not NOW:
                row.put(column, self._glyphs.up, MARK)

    def _mark_now(self, row: Row) -> None:
        column = self._now_column
        if not 0 <= column < len(row.cells):
            return
        if column >= 3:
            row.write(column - 3, f"now{self._glyphs.now}", NOW)
        else:
            row.write(column, f"{self._glyphs.now}now ", NOW)

    def _framed(self, name: list[Run], row: Row, status: Run) -> list[Run]:
        self._show_cursor(row)
        *before, last = name
        room = self._layout.names - sum(len(run.text) for run in before)
        frame = Run(self._glyphs.frame, FAINT)
        text = f" {status.text}" if self._layout.statuses else ""
        return [
            *before,
            Run(fit(last.text, room, self._charset), last.ink),
            frame,
            *row.runs(),
            frame,
            Run(fit(text, self._layout.statuses, self._charset), status.ink),
        ]

    def _show_cursor(self, row: Row) -> None:
        """Show where the cursor stands and what lies after it, when it is not at the edge."""
        column = self._now_column
        at_edge = self._now + self._scale.per_column >= self._edge
        if at_edge or not 0 <= column < len(row.cells):
            return
        if row.blank(column, column + 1):
            row.put(column, self._glyphs.cursor, NOW)
        row.inks[column + 1 :] = [ink._replace(later=True) for ink in row.inks[column + 1 :]]

    def _name(self, lane: Lane) -> list[Run]:
        match lane:
            case ThreadLane(thread):
                wide = len(thread.name) < self._layout.names
                return [Run(thread.name if wide else short_thread(thread.name), PLAIN)]
            case GroupLane(group):
                return [self._letter(group), Run(group.kind.value, PLAIN)]
            case MemberLane(entity):
                return [Run(f"  {self._entity_name(entity, self._layout.names - 3)}", PLAIN)]
            case SoleLane(entity, group):
                return [self._letter(group), Run(self._sole_name(entity, group), PLAIN)]
            case ServiceLane(service):
                return [Run(service, PLAIN)]

    def _letter(self, group: Group) -> Run:
        return Run(f"{group.letter} ", Ink(Role.LETTER, self._numbers[group.id]))

    def _sole_name(self, entity: Entity, group: Group) -> str:
        room = self._layout.names - len(group.letter) - 1
        whole, brief = group.kind.value, group.kind.value[:4]
        names = (entity.label, short(entity.label))
        for text in (f"{kind} {name}" for kind in (whole, brief) for name in names):
            if len(text) <= room:
                return text
        return short(entity.label)

    def _entity_name(self, entity: Entity, room: int) -> str:
        return entity.label if len(entity.label) <= room else short(entity.label)
