"""The log pane: the lines, and below them the input of the filter."""

from typing import ClassVar

from rich.cells import cell_len
from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Vertical
from textual.reactive import var
from textual.widgets import Input, Label

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.keys.keymap import keymap_of
from cbtui.looks.theme import Charset
from cbtui.widgets.log.filter import Filter, FilterError, filter_of
from cbtui.widgets.log.lines import LogLines
from sim.quantities.plural import plural
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline


class LogFilter(Input):
    """The input of the filter: enter keeps the filter, escape clears it."""

    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.FILTER)]

    def __init__(self) -> None:
        super().__init__(
            placeholder='filter: words  "more words"  level:warn  callback:odom  thread:0_1  group:A',
            compact=True,
            select_on_focus=False,
        )

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Move the focus to the lines."""
        event.stop()
        self.screen.query_one(LogLines).focus()

    def action_drop_filter(self) -> None:
        """Clear the filter, and move the focus to the lines."""
        self.value = ""
        self.screen.query_one(LogLines).focus()


class LogView(Vertical):
    """The pane. ``note`` says how much of the log it shows and whether it follows the end."""

    note: var[str] = var("")

    def compose(self) -> ComposeResult:
        """Lay out the lines, the picked line if it is long, the error of the filter, and the filter."""
        yield LogLines()
        yield Label(id="unfolded", markup=False)
        yield Label(id="fault", markup=False)
        yield LogFilter()

    def on_mount(self) -> None:
        """Hide the parts that are not needed yet, and follow the state of the lines."""
        self._complain("")
        self._show_filter()
        lines = self.query_one(LogLines)
        self.watch(lines, "counts", self._note)
        self.watch(lines, "follows", self._note)
        self.watch(lines, "picked", self._unfold)

    def show(self, timeline: Timeline, now: Nanoseconds) -> None:
        """Show the log of a timeline up to a moment."""
        self.query_one(LogLines).show(timeline, now)

    @property
    def filtered(self) -> bool:
        """Whether a filter is on."""
        return bool(self.query_one(LogFilter).value)

    def focus_filter(self) -> None:
        """Show the input of the filter, and focus it."""
        entry = self.query_one(LogFilter)
        entry.display = True
        entry.focus()

    @on(Input.Changed)
    def _filter(self, event: Input.Changed) -> None:
        """Apply the filter as it is typed; an invalid one passes every line."""
        event.stop()
        wanted, fault = _understood(event.value)
        lines = self.query_one(LogLines)
        shows_all = keymap_of(self.app).sign(Scope.FILTER, "drop_filter", Charset.BRAILLE)
        lines.nothing = f"nothing so far matches {event.value}; {shows_all} shows all"
        lines.wanted = wanted
        self._complain(fault)
        self._show_filter()

    @on(LogLines.EveryLineWanted)
    def _clear_filter(self) -> None:
        self.query_one(LogFilter).value = ""

    def on_descendant_focus(self) -> None:
        """Show the filter while it has the focus or is in use."""
        self._show_filter()

    def on_descendant_blur(self) -> None:
        """Hide an empty filter without the focus."""
        self._show_filter()

    def _show_filter(self) -> None:
        entry = self.query_one(LogFilter)
        entry.display = entry.has_focus or self.filtered

    def _complain(self, fault: str) -> None:
        label = self.query_one("#fault", Label)
        label.update(fault)
        label.display = bool(fault)

    def _unfold(self) -> None:
        """Show the picked line in full below the others, if it is wider than the pane."""
        text = self.query_one(LogLines).picked_text
        label = self.query_one("#unfolded", Label)
        label.update(text)
        label.display = cell_len(text) > self.size.width > 0

    def _note(self) -> None:
        lines = self.query_one(LogLines)
        shown, every = lines.counts
        many = f"{every:,} {plural(every, 'line')}"
        part = many if lines.wanted.passes_all else f"{shown:,} of {many}"
        self.note = f"{part} · {'follows' if lines.follows else 'stays'}"


def _understood(text: str) -> tuple[Filter, str]:
    """Return the filter that was typed, and one sentence if it is invalid."""
    try:
        return filter_of(text), ""
    except FilterError as error:
        return Filter(), str(error)
