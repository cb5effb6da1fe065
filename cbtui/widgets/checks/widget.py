"""The checks pane: a picked check leads to its moment."""

from collections.abc import Iterator
from functools import partial
from typing import ClassVar

from rich.segment import Segment
from textual.binding import BindingType
from textual.events import Click
from textual.geometry import Offset, Size
from textual.reactive import var
from textual.strip import Strip

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.widgets.checks.sheet import ChecksLine, ChecksSheet, ChecksStyle, CheckStatus, lines_of
from cbtui.widgets.inked_view import InkedView
from cbtui.widgets.jump import JumpTarget
from sim.trace.model import Nanoseconds

_PICKED = "checks--picked"


class ChecksView(InkedView):
    """Shows a sheet. When the results change, the first failed check is picked."""

    COMPONENT_CLASSES: ClassVar[set[str]] = {*(kind.value for kind in ChecksStyle), _PICKED}
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.CHECKS)]
    can_focus = True

    note: var[str] = var("")
    """A note for the pane's title."""
    picked: var[int | None] = var(None)
    """The index of the picked check."""

    def __init__(self, sheet: ChecksSheet, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id)
        self._sheet = sheet
        self._lines: list[ChecksLine] = []

    def show(self, sheet: ChecksSheet) -> None:
        """Show another sheet."""
        if sheet == self._sheet:
            return
        before, self._sheet = self._sheet, sheet
        self.note = sheet.note
        self._break_lines()
        if [row.status for row in before.rows] != [row.status for row in sheet.rows]:
            self._pick_what_fails()
        self.refresh()

    def on_resize(self) -> None:
        """Break the lines anew."""
        self._break_lines()

    def _break_lines(self) -> None:
        width = self.scrollable_content_region.width
        self._lines = lines_of(self._sheet, width)
        self.virtual_size = Size(width, len(self._lines))

    def _pick_what_fails(self) -> None:
        failing = (place for place, row in enumerate(self._sheet.rows) if row.status is CheckStatus.FAILED)
        self.picked = next(failing, None)
        self.scroll_to(y=0, animate=False, immediate=True, force=True)
        if self.picked is not None:
            self._bring_into_view(self.picked)

    # the keys

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer ``look_there`` unless every check passes and none is picked."""
        if action == "look_there":
            return self.picked is not None or self._sheet.status is not CheckStatus.PASSED
        return super().check_action(action, parameters)

    def action_check_above(self) -> None:
        """Pick the check above; above the first, scroll."""
        if not self.picked:
            self.scroll_to(y=max(0, self.scroll_offset.y - 1), animate=False, force=True)
        else:
            self._pick(self.picked - 1)

    def action_check_below(self) -> None:
        """Pick the check below; below the last, scroll."""
        below = 0 if self.picked is None else self.picked + 1
        if below < len(self._sheet.rows):
            self._pick(below)
        else:
            self.scroll_to(y=self.scroll_offset.y + 1, animate=False, force=True)

    def action_look_there(self) -> None:
        """Tell the moment of the picked check."""
        self.post_message(self.MomentPicked(self._moment))

    def on_click(self, event: Click) -> None:
        """Pick the check under the pointer, and tell its moment."""
        offset = event.get_content_offset(self)
        y = -1 if offset is None else self.scroll_offset.y + offset.y
        row = self._lines[y].row if 0 <= y < len(self._lines) else None
        if row is not None:
            self._go_to(row)

    def jump_targets(self) -> Iterator[JumpTarget]:
        """Yield the checks of which the first line is in view."""
        seen = set[int]()
        top = self.scroll_offset.y
        for y, line in enumerate(self._lines[: top + self.size.height]):
            if line.row is not None and line.row not in seen:
                seen.add(line.row)
                if y >= top:
                    yield JumpTarget(Offset(0, y - top), partial(self._go_to, line.row))

    def _go_to(self, row: int) -> None:
        self._pick(row)
        if self._moment is not None:
            self.action_look_there()

    @property
    def _moment(self) -> Nanoseconds | None:
        return None if self.picked is None else self._sheet.rows[self.picked].at

    def _pick(self, row: int) -> None:
        self.picked = row
        self._bring_into_view(row)
        self.refresh()

    def _bring_into_view(self, row: int) -> None:
        """Scroll as little as possible to show all lines of a check; the first with the news above it."""
        places = [y for y, line in enumerate(self._lines) if line.row == row]
        first, last = 0 if row == 0 else places[0], places[-1]
        height = self.scrollable_content_region.height
        top = min(first, max(self.scroll_offset.y, last - height + 1))
        self.scroll_to(y=top, animate=False, immediate=True, force=True)

    # drawing

    def render_line(self, y: int) -> Strip:
        """Return one line of the view."""
        number = self.scroll_offset.y + y
        width = self.scrollable_content_region.width
        if number >= len(self._lines):
            return Strip.blank(width, self.in_class(""))
        line = self._lines[number]
        picked = line.row is not None and line.row == self.picked
        ground = _PICKED if picked else ""
        pieces = [
            Segment(text, self.on_ground(self.in_class(kind.value), ground)) for text, kind in line.pieces
        ]
        return Strip(pieces).adjust_cell_length(width, self.on_ground(self.in_class(""), ground))
