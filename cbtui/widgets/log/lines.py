"""The lines of the log on screen; draws only those in view, however long the log is."""

from collections.abc import Iterator
from functools import partial
from typing import ClassVar

from rich.segment import Segment
from rich.style import Style
from textual.binding import BindingType
from textual.events import Click
from textual.geometry import Offset
from textual.message import Message
from textual.reactive import var
from textual.strip import Strip

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.looks.theme import GLYPHS, Charset, Ink, Role
from cbtui.text.cells import fit
from cbtui.widgets.following_view import FollowingView
from cbtui.widgets.jump import JumpTarget
from cbtui.widgets.lanes.names import short_thread
from cbtui.widgets.log.filter import Filter, LogEvent
from cbtui.widgets.log.line import line_of, width_of
from cbtui.widgets.log.search import LogSearch
from sim.quantities.durations import timestamp
from sim.quantities.plural import plural
from sim.trace.events import Printed, Severity
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

COLUMNS_FROM = 64
"""The narrowest log that shows thread and group of each line that leaves them room."""

_SEARCH_BATCH = 2000
"""Lines that are searched between two turns of screen and keys; they take some milliseconds."""

_THREAD = 12
"""Columns of a thread's name with the blank behind it."""
_GROUP = 3
_COLUMNS = _THREAD + _GROUP + 1

_STYLES = {
    Severity.DEBUG: "log--debug",
    Severity.INFO: "log--info",
    Severity.WARN: "log--warn",
    Severity.ERROR: "log--error",
    Severity.FATAL: "log--error",
}
_CURSOR, _MOMENT = "log--cursor", "log--moment"


class LogLines(FollowingView):
    """The lines that pass a filter, up to a moment; below them stands the number of later lines.

    A line can be picked with the arrow keys or the pointer; enter, or a click, posts its time.
    """

    COMPONENT_CLASSES: ClassVar[set[str]] = {*_STYLES.values(), _CURSOR, _MOMENT}
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.LOG)]

    class EveryLineWanted(Message):
        """The user wants the filter to be cleared."""

    counts: var[tuple[int, int]] = var((0, 0))
    """The number of lines that pass the filter, and of all lines, up to the moment on screen."""

    picked: var[int | None] = var(None)
    """The place of the picked line in the whole log."""

    def __init__(self) -> None:
        super().__init__()
        self._search = LogSearch(Timeline(), Filter())
        self.nothing = ""
        """What is shown if no line passes the filter."""
        self._now = 0
        self._searching = False
        self._kept: int | None = None
        self._followed = True
        self._later = 0
        self._drawn: tuple[int, ...] = ()

    @property
    def wanted(self) -> Filter:
        """The filter that decides which lines are shown."""
        return self._search.wanted

    @wanted.setter
    def wanted(self, wanted: Filter) -> None:
        if wanted == self._search.wanted:
            return
        timeline, picked = self._search.timeline, self.picked
        self._kept = None if self.follows else self._place_of(self.scroll_offset.y)
        if picked is not None and not wanted.passes(timeline.logs[picked], timeline):
            self.picked = None
        self._search = LogSearch(timeline, wanted)
        self._widest = 0
        self._scan_new_lines()

    def show(self, timeline: Timeline, now: Nanoseconds) -> None:
        """Show the log of a timeline up to a moment."""
        if timeline is not self._search.timeline:
            self._search = LogSearch(timeline, self._search.wanted)
            self.picked = self._kept = None
            self._widest = 0
        self._now = now
        self._scan_new_lines()

    # the shown lines

    def _scan_new_lines(self) -> None:
        """Search some new lines, show the found ones, and continue after other messages."""
        more = self._search.go_on(_SEARCH_BATCH)
        self._grow_to_what_was_found()
        if not more:
            self._kept = None
        elif not self._searching:
            self._searching = True
            self.call_later(self._search_on)

    def _search_on(self) -> None:
        self._searching = False
        self._scan_new_lines()
        if not self._searching:
            self.refresh()  # it is certain now if nothing was found

    def _grow_to_what_was_found(self) -> None:
        timeline = self._search.timeline
        written = timeline.logs_until(self._now)
        count = self._search.until(written)
        if self.picked is not None and self.picked >= written:
            self.picked = None
        looks_back = self._now < timeline.end
        self._later = len(self._search.places) - count if looks_back else 0
        drawn = (id(self._search), count, looks_back, len(timeline.logs))
        if drawn != self._drawn:
            self._drawn = drawn
            self.grow(count, self._widest)
            self._widen()
        elif self._later:
            self.refresh_lines(count)
        if self._kept is not None:
            self._scroll_to_row(self._search.until(self._kept))
        self.counts = (count, written)

    def watch_scroll_y(self, old_value: float, new_value: float) -> None:
        """Widen the view for lines that come into view."""
        super().watch_scroll_y(old_value, new_value)
        self._widen()

    def _widen(self) -> None:
        """Take the width of the widest line so far in view; measuring every line would take too long."""
        rows = range(self.scroll_offset.y, min(self.scroll_offset.y + self._height, self._count))
        logs, places = self._search.timeline.logs, self._search.places
        widest = max((width_of(logs[places[row]]) for row in rows), default=0)
        if widest > self._widest:
            self.grow(self._count, widest)

    def _place_of(self, row: int) -> int:
        """Return the place in the whole log of a line that is shown, or where the next one would be."""
        places = self._search.places
        return places[row] if row < len(places) else len(self._search.timeline.logs)

    # the picked line

    def watch_picked(self, before: int | None, picked: int | None) -> None:
        """Follow the end again once no line is picked, if the log did so before one was."""
        if before is None:
            self._followed = self.follows
        elif picked is None and self._followed:
            self.follow()

    @property
    def picked_text(self) -> str:
        """The picked line as ROS prints it; "" for none."""
        return "" if self.picked is None else line_of(self._search.timeline.logs[self.picked])

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the actions that have an effect on the shown lines."""
        match action:
            case "pick_line":
                return self.picked is not None
            case "let_go":
                return self.picked is not None or not self.wanted.passes_all
            case "line_above" | "line_below" | "copy":
                return self._count > 0
            case "follow":
                return not self.follows
            case "stay":
                return self.follows
        return super().check_action(action, parameters)

    def action_line_above(self) -> None:
        """Pick the line above."""
        self._pick_beside(-1)

    def action_line_below(self) -> None:
        """Pick the line below."""
        self._pick_beside(1)

    def action_pick_line(self) -> None:
        """Post the picked line's time."""
        if self.picked is not None:
            self.post_message(self.MomentPicked(self._search.timeline.logs[self.picked].t))

    def action_copy(self) -> None:
        """Copy the picked line, or else the lines in view, in full."""
        first = self.scroll_offset.y
        rows = range(first, min(first + self._height, self._count))
        places = [self._search.places[row] for row in rows] if self.picked is None else [self.picked]
        self.copy([line_of(self._search.timeline.logs[place]) for place in places])

    def action_follow(self) -> None:
        """Unpick the line, and follow the end."""
        self._unpick()
        self.follow()

    def action_stay(self) -> None:
        """Stop following the end."""
        self.stay()

    def action_let_go(self) -> None:
        """Clear the selection; without one, ask for every line."""
        if self.picked is None:
            self.post_message(self.EveryLineWanted())
        self._unpick()

    def _unpick(self) -> None:
        self.picked = None
        self.refresh()

    def on_click(self, event: Click) -> None:
        """Pick the line under the pointer, and post its time."""
        offset = event.get_content_offset(self)
        row = None if offset is None else self.scroll_offset.y + offset.y
        if row is not None and row < self._count:
            self._go_to(row)

    def jump_targets(self) -> Iterator[JumpTarget]:
        """Yield the lines in view, the latest first."""
        top = self.scroll_offset.y
        for row in reversed(range(top, min(top + self._height, self._count))):
            yield JumpTarget(Offset(0, row - top), partial(self._go_to, row))

    def _go_to(self, row: int) -> None:
        self._pick(row)
        self.action_pick_line()

    def _pick_beside(self, step: int) -> None:
        """Pick the line above or below; at first the last one in view."""
        if not self._count:
            return
        if self.picked is None:
            row = min(self.scroll_offset.y + self._height, self._count) - 1
        else:
            row = self._search.until(self.picked) + step
        self._pick(max(0, min(row, self._count - 1)))

    def _pick(self, row: int) -> None:
        self.picked = self._search.places[row]
        self._scroll_to_row(min(row, max(self.scroll_offset.y, row - self._height + 1)))
        self.stay()
        self.refresh()

    @property
    def _height(self) -> int:
        return self.scrollable_content_region.height

    def _scroll_to_row(self, row: int) -> None:
        self.scroll_to(y=row, animate=False, immediate=True, force=True)

    # drawing

    def below(self) -> int:
        """A row with the number of later lines, if there are any."""
        return 1 if self._later else 0

    def render_line(self, y: int) -> Strip:
        """Return one line of the view."""
        row = self.scroll_offset.y + y
        width = self.scrollable_content_region.width
        if self._later and row == self._count:
            words = later_lines(self._now, self._later, width)
            return Strip([Segment(words, self.in_ink(Ink(Role.FAINT)))], width)
        if row == self.below() and not self._count and not self.wanted.passes_all and not self._searching:
            words = fit(self.nothing, width, Charset.BRAILLE)
            return Strip([Segment(words, self.in_ink(Ink(Role.FAINT)))], width)
        if row >= self._count:
            return Strip.blank(width, self.in_class(""))
        place = self._search.places[row]
        event = self._search.timeline.logs[place]
        text = Strip([Segment(line_of(event), self._text_style(event))])
        parts = self._parts(text, event, width)
        if not (ground := self._ground(place, row)):
            return Strip(parts, width)
        bold = Style(bold=place == self.picked or None)
        return Strip(
            [Segment(part, style and self.on_ground(style, ground) + bold) for part, style, _ in parts], width
        )

    def _parts(self, text: Strip, event: LogEvent, width: int) -> list[Segment]:
        """Return text, thread and group; a text that is long has the room of those as well."""
        left = self.scroll_offset.x
        has_columns = width >= COLUMNS_FROM and text.cell_length - left <= width - _COLUMNS
        room = width - _COLUMNS if has_columns else width
        shown = self.cut(text, left, room).adjust_cell_length(room, self.in_class(""))
        return [*shown, *(self._columns(event) if has_columns else [])]

    def _ground(self, place: int, row: int) -> str:
        """Return the component class of the picked line, of the last before the cursor, or ""."""
        if place == self.picked:
            return _CURSOR
        return _MOMENT if row == self._count - 1 and self._now < self._search.timeline.end else ""

    def _columns(self, event: LogEvent) -> list[Segment]:
        if isinstance(event, Printed):
            return [Segment(" " * _COLUMNS, self.in_class(""))]
        timeline = self._search.timeline
        thread = timeline.threads.get(event.thread)
        entity = timeline.entities.get(event.entity)
        name = short_thread(thread.name) if thread else ""
        group = timeline.groups.get(entity.group) if entity else None
        number = group.place if group else -1
        letter = group.letter if group else ""
        return [
            Segment(f" {fit(name, _THREAD - 1, Charset.BRAILLE)} ", self.in_ink(Ink(Role.FAINT))),
            Segment(fit(letter, _GROUP, Charset.BRAILLE), self.in_ink(Ink(Role.LETTER, number))),
        ]

    def _text_style(self, event: LogEvent) -> Style:
        if isinstance(event, Printed):
            return self.in_class("log--error" if event.error else "log--info")
        return self.in_class(_STYLES[event.severity])


def later_lines(now: Nanoseconds, later: int, width: int) -> str:
    """Return the line at which the cursor stands in the log, and how many lines are yet to come."""
    rule = GLYPHS[Charset.BRAILLE].line
    words = f"{rule} {timestamp(now)}, {later:,} later {plural(later, 'line')} "
    return fit(words + rule * (width - len(words)), width, Charset.BRAILLE)
