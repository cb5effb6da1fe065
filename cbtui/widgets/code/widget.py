"""The source pane: it scrolls, follows running callbacks, and draws only visible lines."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import ClassVar, NamedTuple

from rich.segment import Segment
from textual.binding import BindingType
from textual.events import Click
from textual.geometry import Offset, Size
from textual.message import Message
from textual.reactive import var
from textual.strip import Strip

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.looks.theme import GLYPHS, Charset, Ink, Role
from cbtui.text.cells import fit, visible
from cbtui.widgets.code.following import CallbackFollower, CallbackLines, Step
from cbtui.widgets.code.highlight import SourceToken, TokenKind
from cbtui.widgets.code.marks import (
    CallbackActivity,
    CallbackMark,
    LineMark,
    LineMarks,
    StandingThread,
    changed_lines,
    fault_at,
    lines_at,
    marks_at,
    standing_at,
    text_beside,
)
from cbtui.widgets.code.signs import CODE_SIGNS
from cbtui.widgets.code.source_files import SourceFile, SourceFiles
from cbtui.widgets.inked_view import InkedView
from cbtui.widgets.jump import JumpTarget
from sim.trace.events import EntityId
from sim.trace.model import EntityInfo, Nanoseconds
from sim.trace.timeline import Timeline

_GUTTER = 7
_SIDEWAYS = 8
"""Columns of a step sideways."""

_CURSOR = "code--cursor"

_INKS = {
    CallbackActivity.IDLE: Role.FAINT,
    CallbackActivity.RAN: Role.FAINT,
    CallbackActivity.WAITS: Role.WARN,
    CallbackActivity.AWAITS: Role.LABEL,
    CallbackActivity.RUNS: Role.LABEL,
}


class SourceLocation(NamedTuple):
    """A line of a file, counted from 1."""

    path: Path
    line: int


class CodeView(InkedView):
    """The learner's source; each callback is annotated with its thread, or with the reason of its wait.

    Of several files it shows that of the requested callback, or of one that has run for a while. ``note``
    names the file, and says if it has changed on disk; ``over`` tells whether the run has ended. A line can
    be picked with the arrow keys or the mouse; enter or a click reports its callback. The screen sets
    ``step`` while a step led to the moment.
    """

    COMPONENT_CLASSES: ClassVar[set[str]] = {*(kind.value for kind in TokenKind), _CURSOR}
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.CODE)]

    note: var[str] = var("")
    over: var[bool] = var(False)
    picked: var[int | None] = var(None)
    """The picked line, counted from 1."""

    class EditorWanted(Message):
        """The user wants to open the file in an editor."""

    @dataclass
    class ModuleSaved(Message):
        """Another file of the program than its own, of this name, differs from what runs."""

        name: str

    @dataclass
    class CallbackPicked(Message):
        """The user picked a line of ``entity``'s callback; with ``leaves`` the focus moves to its lane."""

        entity: EntityId
        leaves: bool

    def __init__(
        self,
        path: Path,
        source: str | None = None,
        recorded: Mapping[str, str] = MappingProxyType({}),
        *,
        id: str | None = None,  # noqa: A002 Textual's name for it
    ) -> None:
        super().__init__(id=id)
        self._files = SourceFiles(path, source, recorded)
        self._file = self._files.main
        self._marks: dict[SourceFile, list[CallbackMark]] = {}
        self._lines: dict[SourceFile, LineMarks] = {}
        self._follower = CallbackFollower()
        self.step: Step | None = None
        self.standing: Sequence[StandingThread] = ()
        """The threads that may be chosen, in the order of their numbers."""
        self._told_fault = False
        self._changed = False
        self._drawn: dict[int, Strip] = {}
        self._open(self._file)

    def show(self, timeline: Timeline, now: Nanoseconds) -> None:
        """Mark the callbacks' activities at a moment, and scroll to one that has run for a while."""
        fault = fault_at(timeline, now, self._files)
        lines, lines_before = lines_at(timeline, now, self._files), self._here
        for file, standing in standing_at(self.standing, self._files).items():
            lines[file] = lines.get(file, {}) | standing
        self._lines = lines = lines | fault
        for line in {*lines_before, *self._here}:
            if lines_before.get(line) != self._here.get(line):
                self.refresh_lines(line - 1)
        self._go_to_fault(fault)
        marks = marks_at(timeline, now, self._files)
        if marks != self._marks:
            before, self._marks = self._marked, marks
            for line, count in changed_lines(before, self._marked):
                self.refresh_lines(line - 1, count)
            self._go_to(self._follower.begun(marks, self._file))
        self._go_to(self._follower.stepped(self.step, timeline, self._files))

    def _go_to_fault(self, found: Mapping[SourceFile, LineMarks]) -> None:
        """Go to the line that ended the program, once."""
        for file, lines in found.items() if not self._told_fault else ():
            self.show_line(str(file.path.absolute()), next(iter(lines)))
        self._told_fault = bool(found)

    def show_callback(self, entity: EntityInfo) -> None:
        """Pick a callback's first line and scroll to it, if its source is available."""
        self.show_line(entity.file, entity.first_line)

    def show_line(self, path: str, line: int) -> None:
        """Pick a line, counted from 1, and scroll to it, if the file is available."""
        file = self._files.of(path)
        if file is not None:
            self._open(file)
            self._follower.placed = True
            self.picked = line
            self.call_after_refresh(self._bring_into_view, line - 1)
            self.refresh()

    @property
    def place(self) -> SourceLocation:
        """The picked line, or else the first one in view."""
        return SourceLocation(self._file.path, self.picked or self.scroll_offset.y + 1)

    # files

    def read_anew(self, texts: Mapping[str, str]) -> None:
        """Read the files again, as the next run uses those on disk; ``texts`` in place of some, by path."""
        self._files.read_anew(texts)
        self._follower.forget(placed=self._follower.placed and not self._told_fault)
        self._marks, self._lines = {}, {}
        self._open(self._files.of(str(self._file.path.absolute())) or self._files.main)

    def check_disk(self, entities: Iterable[EntityInfo] = ()) -> None:
        """Check whether the files have changed on disk, those of ``entities`` among them."""
        for entity in entities:
            self._files.of(entity.file)
        self._changed = self._file.has_changed()
        self._name_it()
        other = self._files.changed_beside_main()
        if other is not None:
            self.post_message(self.ModuleSaved(other.path.name))

    def watch_over(self) -> None:
        """Update the note on a changed file."""
        self._name_it()

    def _open(self, file: SourceFile) -> None:
        if file.path != self._file.path:
            self.scroll_to(y=0, animate=False, immediate=True, force=True)
        if file is not self._file:
            self._file = file
            self._drawn = {}
            self._changed = False
            self.picked = None
        self.virtual_size = Size(_GUTTER + file.widest, len(file.lines))
        self._name_it()
        self.refresh()

    def _name_it(self) -> None:
        changed = " · changed; r runs it again" if self.over else " · changed on disk"
        more = changed if self._changed else " · edited copy" if self._file.is_copy else ""
        self.note = visible(self._file.path.name, Charset.BRAILLE) + more

    @property
    def _marked(self) -> list[CallbackMark]:
        return self._marks.get(self._file, [])

    @property
    def _here(self) -> LineMarks:
        return self._lines.get(self._file, {})

    # the picked line

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the actions that are available at the picked line."""
        match action:
            case "pick_callback" | "copy":
                return self.picked is not None and self._marked_at(self.picked) is not None
            case "let_go":
                return self.picked is not None
            case "scroll_left" | "scroll_right":  # Textual's; these keys pan the lanes
                return False
            case "sideways_left":
                return self.scroll_offset.x > 0
            case "sideways_right":
                return self.scroll_offset.x < self.max_scroll_x
        return super().check_action(action, parameters)

    def action_line_above(self) -> None:
        """Go to the line above."""
        self._pick_beside(-1)

    def action_line_below(self) -> None:
        """Go to the line below."""
        self._pick_beside(1)

    def action_sideways_left(self) -> None:
        """Scroll left."""
        self.scroll_relative(x=-_SIDEWAYS, animate=False, force=True)

    def action_sideways_right(self) -> None:
        """Scroll right."""
        self.scroll_relative(x=_SIDEWAYS, animate=False, force=True)

    def action_pick_callback(self) -> None:
        """Report the line's callback, to move to its lane."""
        self._tell_callback(leaves=True)

    def action_open_here(self) -> None:
        """Ask for an editor."""
        self.post_message(self.EditorWanted())

    def action_copy(self) -> None:
        """Copy the callback at the line."""
        marked = None if self.picked is None else self._marked_at(self.picked)
        if marked is not None:
            self.copy(self._file.text.splitlines()[marked.first_line - 1 : marked.last_line])

    def action_let_go(self) -> None:
        """Unpick the line, and follow running callbacks again."""
        self.picked = None
        self.refresh()

    def on_click(self, event: Click) -> None:
        """Pick the line under the mouse, and report its callback."""
        offset = event.get_content_offset(self)
        line = 0 if offset is None else self.scroll_offset.y + offset.y + 1
        if 0 < line <= len(self._file.lines):
            self._pick_and_tell(line)

    def jump_targets(self) -> Iterator[JumpTarget]:
        """Yield the callbacks whose first line is in view."""
        top = self.scroll_offset.y
        for marked in self._marked:
            if top < marked.first_line <= top + self.size.height:
                go = partial(self._pick_and_tell, marked.first_line)
                yield JumpTarget(Offset(0, marked.first_line - 1 - top), go)

    def _pick_and_tell(self, line: int) -> None:
        self._pick(line)
        self._tell_callback(leaves=False)

    def _tell_callback(self, leaves: bool) -> None:
        marked = None if self.picked is None else self._marked_at(self.picked)
        if marked is not None:
            self.post_message(self.CallbackPicked(marked.entity, leaves))

    def _pick_beside(self, step: int) -> None:
        line = self.scroll_offset.y + 1 if self.picked is None else self.picked + step
        self._pick(max(1, min(line, len(self._file.lines))))

    def _pick(self, line: int) -> None:
        self.picked = line
        top = self.scroll_offset.y
        self.scroll_to(y=min(line - 1, max(top, line - self.size.height)), animate=False, force=True)
        self.refresh()

    # drawing

    def notify_style_update(self) -> None:
        """Draw the lines for the new theme."""
        super().notify_style_update()
        self._drawn = {}

    def render_line(self, y: int) -> Strip:
        """Return one line of the view."""
        number = self.scroll_offset.y + y
        width = self.scrollable_content_region.width
        if number >= len(self._file.lines):
            return Strip.blank(width, self.in_class(""))
        marked = self._marked_at(number + 1)
        code, here = self._code(number), self._here.get(number + 1)
        left = self.scroll_offset.x
        if here is not None and here.texts and left == 0:  # code gives way to them: first its indentation
            room = width - _GUTTER - 1
            room -= len(text_beside(here.texts, room - code.cell_length))
            left = max(0, min(code.cell_length - room, len(code.text) - len(code.text.lstrip())))
        code_line = Strip([*self._gutter(number + 1, marked), *self.cut(code, left, width - _GUTTER)])
        if marked is None or marked.first_line != number + 1 or marked.doing is CallbackActivity.IDLE:
            line = code_line.adjust_cell_length(width, self.in_class(""))
        else:
            ink = Ink(_INKS[marked.doing], marked.number)
            line = self._with_text(code_line, marked.texts, ink, width)
        if here is not None and here.texts:
            line = self._with_text(code_line, here.texts, _ink_of(here), width)
        return line if here is None and self.picked != number + 1 else self.set_off(line, _CURSOR)

    def _go_to(self, callback: CallbackLines | None) -> None:
        """Scroll to a callback and the line where it is, or to that alone; a picked line stays."""
        if callback is None or self.picked is not None:
            return
        self._open(callback.file)
        inside = range(callback.first, callback.last + 1)
        there = [line for line, mark in self._here.items() if mark.texts]
        is_in_call = any(line in inside for line in self._here)  # of a function beside it
        at = next((line for line in there if line in inside), next(iter(there), 0) if is_in_call else 0)
        at = at or inside[0]
        seen_with_it = 0 <= at - inside[0] < self.size.height - 2
        self.call_after_refresh(self._bring_into_view, (inside[0] if seen_with_it else at) - 1)

    def _bring_into_view(self, line: int) -> None:
        top, height = self.scroll_offset.y, self.size.height
        if not top <= line < top + height - 2:
            self.scroll_to(y=max(0, line - 1), animate=False, force=True)

    def _marked_at(self, line: int) -> CallbackMark | None:
        """Return the innermost callback that a line belongs to."""
        inside = [marked for marked in self._marked if marked.first_line <= line <= marked.last_line]
        return inside[-1] if inside else None

    def _gutter(self, line: int, marked: CallbackMark | None) -> list[Segment]:
        number = Segment(f"{line:>4} ", self.in_ink(Ink(Role.FAINT)))
        here = self._here.get(line)
        if here is not None and here.fault:
            return [number, Segment(f"{CODE_SIGNS.fault} ", self.in_ink(_ink_of(here)))]
        if marked is not None and marked.first_line == line:
            letter = fit(marked.letter, _GUTTER - 5, Charset.BRAILLE)
            return [number, Segment(letter, self.in_ink(Ink(Role.LETTER, marked.number)))]
        if here is not None:
            sign = CODE_SIGNS.here if here.texts else CODE_SIGNS.calls
            return [number, Segment(f"{sign} ", self.in_ink(Ink(Role.BAR, here.number)))]
        if marked is None:
            return [number, Segment("  ", self.in_class(""))]
        is_running = marked.doing is CallbackActivity.RUNS
        glyph, role = (CODE_SIGNS.runs, Role.BAR) if is_running else (" ", Role.FAINT)
        if marked.reason is not None:
            glyph, role = GLYPHS[Charset.BRAILLE].hatch[marked.reason], Role.HATCH
        return [number, Segment(f"{glyph} ", self.in_ink(Ink(role, marked.number)))]

    def _with_text(self, line: Strip, texts: Sequence[str], ink: Ink, width: int) -> Strip:
        """Put the text that fits beside the code at the right of a line; code may give way to a short one."""
        text = text_beside(texts, width - line.cell_length - 1)
        if text and len(text) >= width - line.cell_length:
            more = Segment("…", self.in_ink(Ink(Role.FAINT)))
            line = Strip([*line.crop(0, width - len(text) - 1), more])
        mark = Segment(text, self.in_ink(ink))
        return Strip([*line.adjust_cell_length(width - len(text), self.in_class("")), mark], width)

    def _code(self, number: int) -> Strip:
        """The drawn line of the file, counted from 0, without scrolling."""
        if number not in self._drawn:
            self._drawn[number] = Strip([self._segment(word) for word in self._file.lines[number]])
        return self._drawn[number]

    def _segment(self, word: SourceToken) -> Segment:
        style = self.in_class(word.kind.value)
        return Segment(visible(word.text, Charset.BRAILLE), style)


def _ink_of(here: LineMark) -> Ink:
    return Ink(Role.WARN) if here.fault else Ink(Role.LABEL, here.number)
