"""Draws lanes between label and status: bars, lines, hatching and their words."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import lru_cache

from cbtui.looks.theme import Glyphs, Ink, Role, texture_of
from cbtui.text.callback_names import short_name
from cbtui.text.cells import CellRow
from cbtui.widgets.lanes.columns import Interval, LaneColumn, MergedColumns, stretches
from cbtui.widgets.lanes.names import short_thread
from cbtui.widgets.lanes.scale import TimeScale
from cbtui.widgets.lanes.selection import Bar, end_of, start_of
from cbtui.widgets.lanes.status import is_late
from sim.quantities.durations import duration
from sim.trace.descriptions import doing_of, why_waiting
from sim.trace.events import Doing, EntityId, EntityKind, Reason
from sim.trace.figures.chains import ChainStep
from sim.trace.figures.waiting import wait_judged
from sim.trace.model import Blocked, EntityInfo, GroupInfo, Nanoseconds, Position, Span, Wait
from sim.trace.timeline import Timeline

_WAIT_SHOWS_FROM = 2
"""Eighths of a column: shorter waits beside calls are not worth hatching."""

_HALF = 4
"""Eighths of a column."""

_WORDS = Ink(Role.STRONG)
_WARN = Ink(Role.WARN)
_NUMBER = Ink(Role.MARK, selected=True)


@dataclass(frozen=True, slots=True)
class BarPainter:
    """Draws calls and waits into rows, up to ``edge``.

    ``now`` is the cursor's time, ``told`` that of the words and figures.
    """

    timeline: Timeline
    glyphs: Glyphs
    now: Nanoseconds
    told: Nanoseconds
    edge: Nanoseconds

    def thread(self, row: CellRow, columns: Sequence[LaneColumn[Span] | None]) -> None:
        """Draw a thread's calls: bars with group letter and callback name, ticks for short ones."""
        for stretch in stretches(columns):
            number = self._number(stretch.top.entity)
            self._columns(row, stretch, _ink(Role.BAR, number))
            if not stretch.is_short:
                self._texture(row, stretch, number)
            if len(stretch.columns) > 1:
                self._seam(row, stretch)
                self._label(row, stretch, Ink(Role.LABEL, number))
                self._inner(row, stretch, Ink(Role.LABEL, number))
            self._failure(row, stretch)

    def _inner(self, row: CellRow, stretch: MergedColumns[Span], ink: Ink) -> None:
        """Mark the calls inside a bar's call, except under its label."""
        for place, column in stretch.places():
            if column.at_once > 1 and row.inks[place].role is not Role.LABEL:
                row.put(place, self.glyphs.inner, ink)

    def inside(self, row: CellRow, positions: Sequence[LaneColumn[Position] | None]) -> None:
        """Draw the lines of code at which a thread's calls are, in free columns."""
        for stretch in stretches(positions):
            if stretch.is_short:
                continue
            at = stretch.top
            number = self._number(at.entity)
            free = [place for place, _ in stretch.places() if row.blank(place, place + 1)]
            for place in free:
                row.put(place, self._doing(at), Ink(Role.LINE, number))
            self._words(row, *_longest_part(free), _texts_at(at))

    def nested(self, row: CellRow, calls: Sequence[tuple[int, int, Span]]) -> None:
        """Draw calls inside other calls, each from its first column to before its ``after``."""
        for first, after, span in calls:
            number = self._number(span.entity)
            row.fill(first, after, self.glyphs.left[8], Ink(Role.BAR, number))
            name = self.timeline.entities[span.entity].spoken_name
            fitting = (text for text in (name, short_name(name)) if len(text) <= after - first)
            row.write(first, next(fitting, ""), Ink(Role.LABEL, number))

    def _doing(self, position: Position) -> str:
        match position.doing:
            case Doing.COMPUTES:
                return self.glyphs.line
            case Doing.SLEEPS:
                return self.glyphs.sleeps
        return self.glyphs.blocked

    def blocked(self, row: CellRow, columns: Sequence[LaneColumn[Blocked] | None]) -> None:
        """Draw where a thread is blocked in a service call, beside the name on its bar."""
        for stretch in stretches(columns):
            where = f"in call {stretch.top.service}"
            self._stands(row, stretch, (f"blocked {where}", where, "blocked"))

    def waiting(self, row: CellRow, columns: Sequence[LaneColumn[Position] | None]) -> None:
        """Draw where a call waits at its line, beside the name on its bar, or the program itself waits."""
        for stretch in stretches(columns):
            doing = doing_of(stretch.top)
            brief = doing.removeprefix("waits ")
            texts = (doing, brief, brief.partition(" ")[2]) if stretch.top.entity else _texts_at(stretch.top)
            self._stands(row, stretch, texts)

    def _stands(
        self, row: CellRow, stretch: MergedColumns[Blocked] | MergedColumns[Position], texts: Sequence[str]
    ) -> None:
        """Draw over a bar that its call stands still, in the columns of which that is half or more."""
        if stretch.is_short:
            return
        ink = Ink(Role.HATCH, self._number(stretch.top.entity) if stretch.top.entity else -1)
        free = {
            place: column.eighths
            for place, column in stretch.places()
            if row.inks[place].role is not Role.LABEL
        }
        for place, eighths in free.items():
            if eighths >= _HALF:
                row.put(place, self.glyphs.blocked, ink)
        self._words(row, *_longest_part([*free]), texts)

    def lost(self, row: CellRow, places: Sequence[int]) -> None:
        """Mark the columns in which a queue lost messages, except under text."""
        for place in places:
            if row.inks[place] not in (_WORDS, _WARN):
                row.put(place, self.glyphs.lost, _WARN)

    def select(self, row: CellRow, bar: Bar, scale: TimeScale) -> None:
        """Make the selected bar stand out."""
        end = end_of(bar)
        self._stand_out(row, start_of(bar), self.now + 1 if end is None else end, scale)

    def mark_step(self, row: CellRow, number: int, step: ChainStep, scale: TimeScale) -> None:
        """Make a step of a chain stand out, with its number where it begins."""
        self._stand_out(row, step.start, step.end, scale)
        first = scale.column_of(step.start)
        if first >= 0:
            row.write(first, str(number), _NUMBER)

    def _stand_out(self, row: CellRow, start: Nanoseconds, end: Nanoseconds, scale: TimeScale) -> None:
        first = max(0, scale.column_of(start))
        after = max(first, scale.column_of(max(start, end - 1)) + 1)
        row.inks[first:after] = [ink._replace(selected=True) for ink in row.inks[first:after]]

    def group(self, row: CellRow, columns: Sequence[LaneColumn[Span] | None], group: GroupInfo) -> None:
        """Draw the callback that holds a group: a line, or a point for an instant."""
        ink = Ink(Role.LINE, group.place)
        if group.is_open:
            self._together(row, columns, ink)
            return
        for stretch in stretches(columns):
            if stretch.is_short:
                row.put(stretch.first, self.glyphs.point, ink)
                continue
            row.fill(stretch.first, stretch.after, self.glyphs.line, ink)
            callback = self.timeline.entities[stretch.top.entity].spoken_name
            thread = self.timeline.threads[stretch.top.thread].name
            held = f"held by {callback}"
            texts = (f"{held} on {short_thread(thread)}", held, f"by {short_name(callback)}")
            self._words(row, stretch.first, stretch.after, texts)

    def kept_columns(self, group: GroupInfo, scale: TimeScale) -> list[tuple[int, int, EntityId]]:
        """Return the stretches in which a suspended call keeps an exclusive group, as ``kept`` draws them."""
        if group.is_open:
            return []
        found = self.timeline.suspensions_in(group.id, scale.window)
        columns = ((scale.column_of(each.start), scale.column_of(each.end), entity) for entity, each in found)
        return [(max(0, first), min(after, scale.columns), entity) for first, after, entity in columns]

    def kept(self, row: CellRow, stretches: Sequence[tuple[int, int, EntityId]], group: GroupInfo) -> None:
        """Draw the suspended call that keeps a group: the line of a holder, where none runs."""
        for first, after, entity in stretches:
            free = [place for place in range(first, after) if row.blank(place, place + 1)]
            for place in free:
                row.put(place, self.glyphs.line, Ink(Role.LINE, group.place))
            name = self.timeline.entities[entity].spoken_name
            texts = (
                f"kept by {name}, which awaits",
                f"kept by {name}",
                f"kept by {short_name(name)}",
                "kept",
            )
            self._words(row, *_longest_part(free), texts)

    def _together(self, row: CellRow, columns: Sequence[LaneColumn[Span] | None], ink: Ink) -> None:
        """Draw an open group: a line where one callback runs, a double line where several do."""
        for stretch in stretches(columns):
            if stretch.is_short and stretch.columns[0].at_once < 2:
                row.put(stretch.first, self.glyphs.point, ink)
                continue
            self._line(row, stretch, ink)
            callback = self.timeline.entities[stretch.top.entity].spoken_name
            most = max(column.at_once for column in stretch.columns)
            texts = (f"{most} at once",) if most > 1 else (f"runs {callback}", f"runs {short_name(callback)}")
            self._words(row, stretch.first, stretch.after, texts)

    def calls(
        self,
        row: CellRow,
        columns: Sequence[LaneColumn[Span] | None],
        entity: EntityInfo,
        marks: Collection[int] = (),
    ) -> None:
        """Draw the calls of a callback: a mark for a short call, a line with its thread for a long one.

        A line that begins where another one ends is set apart from it.
        The columns of ``marks`` stay free of words, as the marks are drawn later.
        """
        number = self._number(entity.id)
        bar, line = Ink(Role.BAR, number), Ink(Role.LINE, number)
        for stretch in stretches(columns):
            if stretch.is_short:
                self._columns(row, stretch, bar)
            else:
                self._line(row, stretch, line)
                if row.cells[: stretch.first + 1][-2:] == [self.glyphs.line] * 2:
                    row.cells[stretch.first] = self.glyphs.line_start
                span = stretch.top
                thread = short_thread(self.timeline.threads[span.thread].name)
                runs = [f"runs {took}".rstrip() for took in self._took(span)]
                texts = (*(text for each in runs for text in (f"{each} on {thread}", each)), "runs")
                free = [place for place, _ in stretch.places() if place not in marks]
                self._words(row, *_longest_part(free), texts)
            self._failure(row, stretch)

    def late(self, row: CellRow, columns: Sequence[LaneColumn[Span] | None], entity: EntityInfo) -> None:
        """Write beside a timer's late calls that they were late, in free columns."""
        for stretch in stretches(columns) if entity.kind is EntityKind.TIMER else ():
            if is_late(stretch.top, entity):
                self._late(row, stretch)

    def judged(self, columns: Sequence[LaneColumn[Wait] | None]) -> list[LaneColumn[Wait] | None]:
        """Return the columns of a callback's waits, with the one that lasts as it is told at ``told``."""
        moment = self.timeline.moment(self.told)
        return [each and each._replace(top=wait_judged(each.top, moment, self.timeline)) for each in columns]

    def waits(
        self,
        row: CellRow,
        columns: Sequence[LaneColumn[Wait] | None],
        calls: Sequence[LaneColumn[Span] | None],
        marks: Collection[int] = (),
    ) -> None:
        """Draw the waits of a callback: hatching, and the reason in words; ``marks`` as for ``calls``."""
        for stretch in stretches(columns):
            number = self._number(stretch.top.entity)
            hatch = self.glyphs.hatch[stretch.top.reason]
            shown = [place for place, column in stretch.places() if _shows_wait(column, calls[place])]
            if len(shown) > 1 and calls[shown[-1]] is not None and shown[-1] == stretch.after - 1:
                del shown[-1]
            for place in shown:
                row.put(place, hatch, Ink(Role.HATCH, number))
            first, after = _longest_part([place for place in shown if place not in marks])
            self._words(row, first, after, self._reasons(stretch.top))

    def _reasons(self, wait: Wait) -> tuple[str, ...]:
        """Return texts on why a callback waits, the fullest first."""
        took = self._took(wait)
        verb = "waits" if wait.end is None or wait.end > self.told else "waited"
        reasons = self._words_of(wait)
        if took == [""]:
            return reasons
        full = (f"{verb} {each}: {reason}" for each in took for reason in reasons)
        return (*full, f"{took[-1]}: {reasons[-1]}", *reasons, f"{verb} {took[-1]}", took[-1])

    def _took(self, interval: Interval) -> list[str]:
        """Return texts on how long an interval has lasted at ``told``; "" if it begins then or later.

        Of one that is drawn beyond the cursor the first also tells of how long a time that is.
        """
        if interval.start >= self.told:
            return [""]
        end = self.edge if interval.end is None else interval.end
        took = duration(max(0, min(end, self.told) - interval.start))
        goes_on = self.now < min(end, self.edge)
        return [f"{took} of {duration(end - interval.start)}", took] if goes_on else [took]

    def _words_of(self, wait: Wait) -> tuple[str, ...]:
        if wait.reason is Reason.EVENT_QUEUE:
            return (wait.reason.value, "in the event queue")
        if wait.reason is not Reason.GROUP_HELD:
            return (wait.reason.value,)
        if wait.holder == wait.entity:
            return ("its last call still runs", "still runs")
        full = why_waiting(wait, self.timeline)
        brief = full.removeprefix("group ")
        return (full, brief, short_name(brief))

    def _columns(self, row: CellRow, stretch: MergedColumns[Span], ink: Ink) -> None:
        """Draw a stretch as a bar; nothing is drawn there yet."""
        left, right = self.glyphs.left, self.glyphs.right
        for place, column in stretch.places():
            row.cells[place] = (right if column.runs_on else left)[column.eighths]
            row.inks[place] = ink

    def _texture(self, row: CellRow, stretch: MergedColumns[Span], number: int) -> None:
        """Fill the bar's full columns, except at its ends, with the group's texture."""
        glyph, ink = texture_of(number, self.glyphs)
        if glyph == self.glyphs.left[8]:
            return
        first = stretch.first + (stretch.columns[0].eighths < 8)
        after = stretch.after - (stretch.columns[-1].eighths < 8)
        row.fill(first, max(first, after), glyph, ink)

    def _line(self, row: CellRow, stretch: MergedColumns[Span], ink: Ink) -> None:
        """Draw a stretch as a line, double where there are several; nothing is drawn there yet."""
        one, several = self.glyphs.line, self.glyphs.double_line
        for place, column in stretch.places():
            row.cells[place] = several if column.at_once > 1 else one
            row.inks[place] = ink

    def _seam(self, row: CellRow, stretch: MergedColumns[Span]) -> None:
        """Separate a bar from the one directly before it."""
        before = stretch.first - 1
        if before < 0:
            return
        ink = row.inks[before]
        if ink.role is Role.TEXTURE:
            row.inks[before] = ink._replace(role=Role.BAR)
            row.cells[before] = self.glyphs.left[7]
        elif row.cells[before] == self.glyphs.left[8]:
            row.cells[before] = self.glyphs.left[7]

    def _label(self, row: CellRow, stretch: MergedColumns[Span], ink: Ink) -> None:
        full = [place for place, column in stretch.places() if column.eighths == 8]
        if len(full) < 2:
            return
        entity = self.timeline.entities[stretch.top.entity]
        letter = self.timeline.groups[entity.group].letter
        name = entity.spoken_name
        for text in (f"{letter} {name}", f"{letter} {short_name(name)}", letter):
            if len(text) + 3 <= len(full) or text == letter:
                row.write(full[0], f"{text} ", ink)
                return

    def _failure(self, row: CellRow, stretch: MergedColumns[Span]) -> None:
        if stretch.top.error:
            row.put(stretch.after - 1, self.glyphs.cross, _WARN)

    def _late(self, row: CellRow, stretch: MergedColumns[Span]) -> None:
        after = stretch.after
        for text in (f"late {duration(stretch.top.age)}", "late", "!"):
            if row.blank(after, after + len(text)):
                row.write(after, text, _WARN)
                return

    def _words(self, row: CellRow, first: int, after: int, texts: Sequence[str]) -> None:
        """Write the first text that fits between two columns without covering all of what it names."""
        for text in texts:
            if len(text) + 5 <= after - first:
                row.write(first + 2, f" {text} ", _WORDS)
                return

    def _number(self, entity: EntityId) -> int:
        return self.timeline.groups[self.timeline.entities[entity].group].place


def _texts_at(position: Position) -> tuple[str, ...]:
    doing, line = doing_of(position), position.line
    return f"{doing}, line {line}", f"{doing} :{line}", doing, f":{line}"


@lru_cache
def _ink(role: Role, number: int) -> Ink:
    return Ink(role, number)


def _shows_wait(wait: LaneColumn[Wait], call: LaneColumn[Span] | None) -> bool:
    """Whether a column shows the wait: its share exceeds that of the calls, and is large enough to see."""
    if call is None:
        return True
    return wait.eighths >= _WAIT_SHOWS_FROM and wait.eighths > call.eighths


def _longest_part(places: Sequence[int]) -> tuple[int, int]:
    """Return the longest part without a gap of ascending columns: its first, and the one after it."""
    longest = first = after = 0
    best = (0, 0)
    for place in places:
        first = first if place == after else place
        after = place + 1
        if after - first > longest:
            longest, best = after - first, (first, after)
    return best
