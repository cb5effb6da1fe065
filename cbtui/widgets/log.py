"""What the program wrote, as ROS prints it; draws only the lines in view, however long the log is."""

from typing import ClassVar

from rich.cells import cell_len
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from cbtui.theme import Charset, Ink, Role
from cbtui.widgets.cells import fit, visible
from cbtui.widgets.following import Following
from cbtui.widgets.lanes.bars import short_thread
from sim.trace.events import Logged, Printed, Severity
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

COLUMNS_FROM = 70
"""The narrowest log that shows thread and group of each line."""

_THREAD = 12
_GROUP = 3
_COLUMNS = _THREAD + _GROUP + 1

_STYLES = {
    Severity.DEBUG: "log--debug",
    Severity.INFO: "log--info",
    Severity.WARN: "log--warn",
    Severity.ERROR: "log--error",
    Severity.FATAL: "log--error",
}


class LogView(Following):
    """The log up to a moment. It stays at the end unless the person scrolls away from there."""

    COMPONENT_CLASSES: ClassVar[set[str]] = {*_STYLES.values()}

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id)
        self._timeline = Timeline()
        self._measured = 0

    def show(self, timeline: Timeline, now: Nanoseconds) -> None:
        """Show the log of a timeline up to a moment."""
        if timeline is not self._timeline:
            self._timeline = timeline
            self._measured = self._widest = 0
        count = timeline.logs_until(now)
        if count == self._count and self._measured == len(timeline.logs):
            return
        self.grow(count, self._measure())

    def beside(self) -> int:
        """Columns for thread and group, where there is room."""
        return _COLUMNS if self.scrollable_content_region.width >= COLUMNS_FROM else 0

    def render_line(self, y: int) -> Strip:
        """Return one line of the view."""
        place = self.scroll_offset.y + y
        width = self.scrollable_content_region.width
        if place >= self._count:
            return Strip.blank(width, self.in_class(""))
        event = self._timeline.logs[place]
        columns = self._columns(event) if width >= COLUMNS_FROM else []
        room = width - sum(segment.cell_length for segment in columns)
        text = Strip([Segment(line_of(event), self._text_style(event))])
        left = self.scroll_offset.x
        shown = text.crop(left, left + room).adjust_cell_length(room, self.in_class(""))
        return Strip([*shown, *columns], width)

    def _measure(self) -> int:
        """How wide the widest line is; each is measured once."""
        new = self._timeline.logs[self._measured :]
        self._measured += len(new)
        return max([self._widest, *(cell_len(line_of(event)) for event in new)])

    def _columns(self, event: Logged | Printed) -> list[Segment]:
        if isinstance(event, Printed):
            return [Segment(" " * _COLUMNS, self.in_class(""))]
        thread = self._timeline.threads.get(event.thread)
        entity = self._timeline.entities.get(event.entity)
        name = short_thread(thread.name) if thread else ""
        group = self._timeline.groups.get(entity.group) if entity else None
        number = list(self._timeline.groups).index(group.id) if group else -1
        letter = group.letter if group else ""
        return [
            Segment(f" {fit(name, _THREAD, Charset.BRAILLE)}", self.in_ink(Ink(Role.FAINT))),
            Segment(fit(letter, _GROUP, Charset.BRAILLE), self.in_ink(Ink(Role.LETTER, number))),
        ]

    def _text_style(self, event: Logged | Printed) -> Style:
        if isinstance(event, Printed):
            return self.in_class("log--error" if event.error else "log--info")
        return self.in_class(_STYLES[event.severity])


def line_of(event: Logged | Printed) -> str:
    """Return a line as ROS prints it, with seconds of run time as its stamp; safe to send to a terminal."""
    if isinstance(event, Printed):
        return visible(event.text, Charset.BRAILLE)
    head = f"[{event.severity}] [{event.t / 1e9:.3f}] [{event.logger}]: "
    return visible(head + event.text, Charset.BRAILLE)
