"""The source on screen: scrolls, follows what runs, and draws only the lines in view."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar

from rich.segment import Segment
from textual.geometry import Size
from textual.strip import Strip

from cbtui.theme import GLYPHS, Charset, Ink, Role
from cbtui.widgets.cells import fit, visible
from cbtui.widgets.code.highlight import Kind, Word, highlight
from cbtui.widgets.code.marks import Doing, Marked, Marks
from cbtui.widgets.inked import Inked
from sim.trace.events import Reason
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_GUTTER = 7
_LEAST_CODE = 20

_INKS = {Doing.IDLE: Role.FAINT, Doing.RAN: Role.FAINT, Doing.WAITS: Role.WARN, Doing.RUNS: Role.LABEL}
_EDGES = {
    Doing.RUNS: ("▌", Role.BAR),
    Doing.WAITS: (GLYPHS[Charset.BRAILLE].hatch[Reason.GROUP_HELD], Role.HATCH),
}


class CodeView(Inked):
    """A node's source; beside each callback stands which thread runs it, or that it waits and why."""

    COMPONENT_CLASSES: ClassVar[set[str]] = {kind.value for kind in Kind}

    def __init__(
        self,
        path: Path,
        source: str | None = None,
        *,
        id: str | None = None,  # noqa: A002 Textual's name for it
    ) -> None:
        super().__init__(id=id)
        text = path.read_text(encoding="utf-8", errors="replace") if source is None else source
        self._lines = highlight(text)
        self._marks = Marks(path)
        self._marked: list[Marked] = []
        self._long: tuple[int, ...] = ()
        self._placed = False
        widest = max((_length(line) for line in self._lines), default=0)
        self.virtual_size = Size(_GUTTER + widest, len(self._lines))

    def show(self, timeline: Timeline, now: Nanoseconds) -> None:
        """Mark what the callbacks do at a moment; go to one that has begun to run for a while."""
        marked = self._marks.at(timeline, now)
        if marked == self._marked:
            return
        before, self._marked = self._marked, marked
        for line, count in changed_lines(before, marked):
            self.refresh_lines(line - 1, count)
        self._follow()

    def render_line(self, y: int) -> Strip:
        """Return one line of the view."""
        number = self.scroll_offset.y + y
        width = self.scrollable_content_region.width
        if number >= len(self._lines):
            return Strip.blank(width, self.in_class(""))
        marked = self._marked_at(number + 1)
        code = Strip([self._segment(word) for word in self._lines[number]])
        left = self.scroll_offset.x
        line = Strip([*self._gutter(number + 1, marked), *code.crop(left, left + width - _GUTTER)])
        if marked is None or marked.first_line != number + 1 or marked.doing is Doing.IDLE:
            return line.adjust_cell_length(width, self.in_class(""))
        return self._with_mark(line, marked, width)

    def _follow(self) -> None:
        """Bring a callback into view that runs for a while now and did not before; at first, any."""
        long = tuple(marked.first_line for marked in self._marked if marked.running_long)
        begun = [line for line in long if line not in self._long]
        self._long = long
        if not self._placed and self._marked:
            self._placed = True
            begun = begun or [self._marked[0].first_line]
        if begun:
            self.call_after_refresh(self._bring_into_view, begun[0] - 1)

    def _bring_into_view(self, line: int) -> None:
        top, height = self.scroll_offset.y, self.size.height
        if not top <= line < top + height - 2:
            self.scroll_to(y=max(0, line - 1), animate=False, force=True)

    def _marked_at(self, line: int) -> Marked | None:
        """Return the innermost callback that a line belongs to."""
        inside = [marked for marked in self._marked if marked.first_line <= line <= marked.last_line]
        return inside[-1] if inside else None

    def _gutter(self, line: int, marked: Marked | None) -> list[Segment]:
        number = Segment(f"{line:>4} ", self.in_ink(Ink(Role.FAINT)))
        if marked is None:
            return [number, Segment("  ", self.in_class(""))]
        if marked.first_line == line:
            letter = fit(marked.letter, _GUTTER - 5, Charset.BRAILLE)
            return [number, Segment(letter, self.in_ink(Ink(Role.LETTER, marked.number)))]
        glyph, role = _EDGES.get(marked.doing, (" ", Role.FAINT))
        return [number, Segment(f"{glyph} ", self.in_ink(Ink(role, marked.number)))]

    def _with_mark(self, line: Strip, marked: Marked, width: int) -> Strip:
        """Put what a callback does at the right, in as many words as the code leaves room for."""
        room = width - line.cell_length - 1
        texts = [f" {text} " for text in marked.texts]
        text = next((text for text in texts if len(text) <= room), texts[-1])
        text = fit(text, min(len(text), max(0, width - _LEAST_CODE)), Charset.BRAILLE)
        mark = Segment(text, self.in_ink(Ink(_INKS[marked.doing], marked.number)))
        return Strip([*line.adjust_cell_length(width - len(text), self.in_class("")), mark], width)

    def _segment(self, word: Word) -> Segment:
        style = self.in_class(word.kind.value)
        return Segment(visible(word.text, Charset.BRAILLE), style)


def changed_lines(before: Sequence[Marked], after: Sequence[Marked]) -> Iterator[tuple[int, int]]:
    """Yield the first line and the number of lines of each stretch of source that looks different."""
    known = {marked.first_line: marked for marked in before}
    for marked in after:
        old = known.pop(marked.first_line, None)
        if old == marked:
            continue
        alike = old is not None and old.doing is marked.doing and old.number == marked.number
        yield marked.first_line, 1 if alike else marked.last_line - marked.first_line + 1
    for gone in known.values():
        yield gone.first_line, gone.last_line - gone.first_line + 1


def _length(line: list[Word]) -> int:
    return sum(len(word.text) for word in line)
