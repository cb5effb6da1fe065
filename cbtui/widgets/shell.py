"""The shell pane: ``ros2`` lines, what they wrote, and a prompt with history and completion."""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import takewhile
from typing import ClassVar, NamedTuple

from rich.cells import cell_len
from rich.segment import Segment
from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Vertical
from textual.message import Message
from textual.strip import Strip
from textual.widgets import Input, Label

from cbtui.actions import Scope, bindings_of
from cbtui.theme import Charset
from cbtui.widgets.cells import visible, without_tabs
from cbtui.widgets.following import Following
from sim.trace.events import LineEnded, LineGiven, LineSaid
from sim.trace.model import Nanoseconds
from sim.trace.timeline import ShellEvent, Timeline

_HISTORY = 200
"""Lines that the prompt remembers."""
_OFFERED = 60
"""Completions that are listed at most."""


class _Row(NamedTuple):
    t: Nanoseconds
    text: str
    component: str


class ShellOutput(Following):
    """The lines that were given and what they wrote, up to a moment."""

    COMPONENT_CLASSES: ClassVar[set[str]] = {"shell--given", "shell--said", "shell--error", "shell--status"}

    def __init__(self) -> None:
        super().__init__()
        self._timeline = Timeline()
        self._rows: list[_Row] = []
        self._read = 0

    def show(self, timeline: Timeline, now: Nanoseconds) -> None:
        """Show what a timeline holds up to a moment."""
        if timeline is not self._timeline:
            self._timeline = timeline
            self._rows.clear()
            self._read = 0
            self._widest = 0
        new = timeline.shell[self._read :]
        self._read += len(new)
        rows = [row for event in new for row in _rows_of(event)]
        self._rows += rows
        count = bisect_right(self._rows, now, key=lambda row: row.t)
        if rows or count != self._count:
            self.grow(count, max([self._widest, *(cell_len(row.text) for row in rows)]))

    def render_line(self, y: int) -> Strip:
        """Return one line of the view."""
        place = self.scroll_offset.y + y
        width = self.scrollable_content_region.width
        if place >= self._count:
            return Strip.blank(width, self.in_class(""))
        row = self._rows[place]
        left = self.scroll_offset.x
        text = Strip([Segment(row.text, self.in_class(row.component))])
        return text.crop(left, left + width).adjust_cell_length(width, self.in_class(""))


def _rows_of(event: ShellEvent) -> Iterator[_Row]:
    match event:
        case LineGiven(t=t, text=text):
            for part in f"$ {text}".split("\n"):
                yield _Row(t, visible(part, Charset.BRAILLE), "shell--given")
        case LineSaid(t=t, text=text, error=error):
            for part in without_tabs(text).split("\n"):
                yield _Row(t, visible(part, Charset.BRAILLE), "shell--error" if error else "shell--said")
        case LineEnded(t=t, status=status) if status:
            yield _Row(t, f"(ended with status {status})", "shell--status")


class Prompt(Input):
    """Where a line is typed: up and down go through the lines before, tab completes, ctrl+c interrupts."""

    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.PROMPT)]

    class Given(Message):
        """A line is to be carried out."""

        def __init__(self, text: str) -> None:
            super().__init__()
            self.text = text

    class Interrupted(Message):
        """The line that goes on is to end."""

    class CompletionWanted(Message):
        """What could stand at the cursor is asked for."""

        def __init__(self, text: str, cursor: int) -> None:
            super().__init__()
            self.text = text
            self.cursor = cursor

    def __init__(self) -> None:
        super().__init__(
            placeholder="a ros2 line, such as ros2 topic list", compact=True, select_on_focus=False
        )
        self._history: list[str] = []
        self._place = 0

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Give the line."""
        event.stop()
        text = self.value.strip()
        if not text:
            return
        self._history = [*[each for each in self._history if each != text][-_HISTORY:], text]
        self._place = len(self._history)
        self.value = ""
        self.post_message(self.Given(text))

    def action_older(self) -> None:
        """Bring back the line before."""
        self._go_to(self._place - 1)

    def action_newer(self) -> None:
        """Go on to the line after."""
        self._go_to(self._place + 1)

    def _go_to(self, place: int) -> None:
        if 0 <= place <= len(self._history):
            self._place = place
            self.value = [*self._history, ""][place]
            self.cursor_position = len(self.value)

    def action_complete(self) -> None:
        """Ask what could stand here."""
        self.post_message(self.CompletionWanted(self.value, self.cursor_position))

    def action_interrupt(self) -> None:
        """End the line that goes on."""
        self.post_message(self.Interrupted())

    def action_leave_prompt(self) -> None:
        """Let the keys mean what they mean elsewhere again."""
        self.screen.query_one(ShellOutput).focus()

    def complete(self, start: int, words: tuple[str, ...]) -> None:
        """Put in from ``start`` what all ``words`` have in common; the only one is followed by a blank."""
        rest = self.value[self.cursor_position :]
        if len(words) == 1:
            common, rest = f"{words[0]} ", rest.lstrip()
        else:
            common = _common_beginning(words)
        if common.startswith(self.value[start : self.cursor_position]) or len(words) == 1:
            self.value = self.value[:start] + common + rest
            self.cursor_position = start + len(common)


def _common_beginning(words: Sequence[str]) -> str:
    pairs = zip(min(words), max(words), strict=False)
    return "".join(first for first, _ in takewhile(lambda pair: pair[0] == pair[1], pairs))


class ShellView(Vertical):
    """The pane: output above, the prompt below."""

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id)
        self._completed = 0
        self._offered_for = ""

    def compose(self) -> ComposeResult:
        """Lay out output, completions and prompt."""
        yield ShellOutput()
        yield Label(id="offered", markup=False)
        yield Prompt()

    def show(self, timeline: Timeline, now: Nanoseconds) -> None:
        """Show the lines of a timeline up to a moment, and take a completion that has come."""
        self.query_one(ShellOutput).show(timeline, now)
        completed = timeline.completed
        if completed is not None and completed.line != self._completed:
            self._completed = completed.line
            self._offer(completed.start, completed.words)

    def _offer(self, start: int, words: tuple[str, ...]) -> None:
        prompt, offered = self.query_one(Prompt), self.query_one("#offered", Label)
        if words:
            prompt.complete(start, words)
        many = len(words) > 1
        more = f" … {len(words) - _OFFERED} more" if len(words) > _OFFERED else ""
        offered.update(
            "  ".join(visible(word, Charset.BRAILLE) for word in words[:_OFFERED]) + more if many else ""
        )
        offered.display = many
        self._offered_for = prompt.value

    @on(Input.Changed)
    def _forget_offer(self, event: Input.Changed) -> None:
        if event.value != self._offered_for:
            self.query_one("#offered", Label).display = False

    def focus_prompt(self) -> None:
        """Let the person type."""
        self.query_one(Prompt).focus()
