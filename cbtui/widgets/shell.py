"""The shell pane: ``ros2`` lines with their output, a prompt, and the keyboard of programs."""

from bisect import bisect_right
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from os.path import commonprefix
from typing import ClassVar, NamedTuple

from rich.cells import chop_cells
from rich.segment import Segment
from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Vertical
from textual.events import Key
from textual.message import Message
from textual.reactive import reactive
from textual.strip import Strip
from textual.widgets import Input, Label

from cbtui.keys.action import Scope
from cbtui.keys.actions import ACTIONS
from cbtui.keys.bindings import bindings_of
from cbtui.keys.keymap import Keymap, keymap_of
from cbtui.looks.theme import Charset
from cbtui.text.cells import visible, without_tabs
from cbtui.widgets.following_view import FollowingView
from sim.engine.commands import INTERRUPT
from sim.trace.events import KeyboardAsked, LineEnded, LineGiven, LineSaid, Printed, Reading, Typed
from sim.trace.model import Nanoseconds
from sim.trace.timeline import ShellEvent, Timeline

_HISTORY = 200
"""Lines that the prompt remembers."""
_OFFERED = 60
"""Completions that are listed at most."""
_EXAMPLE = "a ros2 line, such as ros2 topic list"


_SEQUENCES = {
    "enter": "\r",
    "up": "\x1b[A",
    "down": "\x1b[B",
    "right": "\x1b[C",
    "left": "\x1b[D",
    "home": "\x1b[H",
    "end": "\x1b[F",
    "delete": "\x1b[3~",
    "backspace": "\x7f",
}
"""Escape sequences that a terminal sends for keys without a character of their own."""


class _OutputRow(NamedTuple):
    t: Nanoseconds
    text: str
    component: str


class ShellOutput(FollowingView):
    """The lines that were run and their output, up to a moment; long ones take several rows."""

    COMPONENT_CLASSES: ClassVar[set[str]] = {"shell--given", "shell--said", "shell--error", "shell--status"}

    def __init__(self) -> None:
        super().__init__()
        self._timeline = Timeline()
        self._lines: list[_OutputRow] = []
        self._rows: list[_OutputRow] = []
        """The lines, in rows of ``_columns``."""
        self._columns = 0
        self._now = 0
        self._read = 0
        self._line_begun = False

    def show(self, timeline: Timeline, now: Nanoseconds) -> None:
        """Show the lines and output of a timeline up to a moment."""
        if timeline is not self._timeline:
            self._timeline = timeline
            self._lines.clear()
            self._rows.clear()
            self._read = 0
        new = timeline.shell[self._read :]
        self._read += len(new)
        lines: list[_OutputRow] = []
        for event in new:
            if isinstance(event, Typed) and self._line_begun:
                begun = lines.pop() if lines else self._take_back()
                lines.append(begun._replace(text=begun.text + _shown(event.text.removesuffix("\n"))))
            else:
                lines += _lines_of(event)
            if isinstance(event, Printed | Typed):
                self._line_begun = isinstance(event, Printed) and not event.ends
        self._lines += lines
        self._rows += self._in_rows(lines)
        self._now = now
        self._show_rows(bool(lines))

    def on_resize(self) -> None:
        """Break the lines anew, and stay at the end."""
        columns = self.scrollable_content_region.width
        if columns and columns != self._columns:
            self._columns = columns
            self._rows = self._in_rows(self._lines)
            self._show_rows(True)
        super().on_resize()

    def _take_back(self) -> _OutputRow:
        """Remove the last line, whose rest is typed now."""
        line = self._lines.pop()
        del self._rows[-len(self._in_rows([line])) :]
        return line

    def _in_rows(self, lines: Iterable[_OutputRow]) -> list[_OutputRow]:
        """Break lines into rows, as a terminal does."""
        columns = self._columns
        return [
            line._replace(text=part)
            for line in lines
            for part in (chop_cells(line.text, columns) if columns else ()) or (line.text,)
        ]

    def _show_rows(self, is_changed: bool) -> None:
        count = bisect_right(self._rows, self._now, key=lambda row: row.t)
        if is_changed or count != self._count:
            self.grow(count, self._columns)

    def render_line(self, y: int) -> Strip:
        """Return one line of the view."""
        place = self.scroll_offset.y + y
        width = self.scrollable_content_region.width
        if place >= self._count:
            return Strip.blank(width, self.in_class(""))
        row = self._rows[place]
        text = Strip([Segment(row.text, self.in_class(row.component))])
        return text.adjust_cell_length(width, self.in_class(""))


def _lines_of(event: ShellEvent) -> Iterator[_OutputRow]:
    match event:
        case LineGiven(t=t, text=text):
            for part in f"$ {text}".split("\n"):
                yield _OutputRow(t, visible(part, Charset.BRAILLE), "shell--given")
        case LineSaid(t=t, text=text, error=error):
            for part in without_tabs(text).split("\n"):
                yield _OutputRow(
                    t, visible(part, Charset.BRAILLE), "shell--error" if error else "shell--said"
                )
        case Printed(t=t, text=text, error=error):
            yield _OutputRow(t, _shown(text), "shell--error" if error else "shell--said")
        case Typed(t=t, text=text):
            yield _OutputRow(t, _shown(text.removesuffix("\n")), "shell--given")
        case LineEnded(t=t, status=status) if status:
            yield _OutputRow(t, f"(ended with status {status})", "shell--status")


def _shown(text: str) -> str:
    return visible(without_tabs(text), Charset.BRAILLE)


class Prompt(Input):
    """The prompt: up and down browse the history, tab completes, ctrl+c interrupts."""

    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.PROMPT)]

    @dataclass
    class LineSubmitted(Message):
        """The user has entered a line."""

        text: str

    class LineInterrupted(Message):
        """The user wants to interrupt the running line."""

    @dataclass
    class CompletionWanted(Message):
        """The user wants completions at the cursor."""

        text: str
        cursor: int

    def __init__(self) -> None:
        super().__init__(compact=True, select_on_focus=False)
        self._history: list[str] = []
        self._place = 0
        self._asked_at = ("", 0)
        """The line and the cursor for which completions were wanted last."""

    def on_mount(self) -> None:
        """Show the hint for a prompt without the focus."""
        self.on_blur()

    def on_blur(self) -> None:
        """Show the key that leads here."""
        way = keymap_of(self.app).sign(Scope.LESSON, "prompt", Charset.BRAILLE)
        self.placeholder = f"{way} types {_EXAMPLE}"

    def on_focus(self) -> None:
        """Show the keys of the prompt."""
        self.placeholder = _EXAMPLE

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Give the line."""
        event.stop()
        text = self.value.strip()
        if not text:
            return
        self._history = [*[each for each in self._history if each != text][-_HISTORY:], text]
        self._place = len(self._history)
        self.value = ""
        self.post_message(self.LineSubmitted(text))

    def action_older(self) -> None:
        """Show the previous line of the history."""
        self._go_to(self._place - 1)

    def action_newer(self) -> None:
        """Show the next line of the history."""
        self._go_to(self._place + 1)

    def _go_to(self, place: int) -> None:
        if 0 <= place <= len(self._history):
            self._place = place
            self.value = [*self._history, ""][place]
            self.cursor_position = len(self.value)

    def action_complete(self) -> None:
        """Ask for completions at the cursor."""
        self._asked_at = self.value, self.cursor_position
        self.post_message(self.CompletionWanted(*self._asked_at))

    @property
    def is_as_asked(self) -> bool:
        """Whether the line and the cursor are still those for which completions were wanted."""
        return self._asked_at == (self.value, self.cursor_position)

    def action_interrupt(self) -> None:
        """Interrupt the running line."""
        self.post_message(self.LineInterrupted())

    def action_leave_prompt(self) -> None:
        """Move the focus to the output, where the other keys work again."""
        self.screen.query_one(ShellOutput).focus()

    def complete(self, start: int, words: tuple[str, ...]) -> None:
        """Insert the common prefix of ``words`` at ``start``; a single word is followed by a blank."""
        rest = self.value[self.cursor_position :]
        if len(words) == 1:
            common, rest = f"{words[0]} ", rest.lstrip()
        else:
            common = commonprefix(words)  # noqa: RUF071 -- letter by letter
        if common.startswith(self.value[start : self.cursor_position]) or len(words) == 1:
            self.value = self.value[:start] + common + rest
            self.cursor_position = start + len(common)


class ProgramKeyboard(Input):
    """The keyboard of a program that reads: lines, or single keys."""

    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.KEYBOARD)]
    reads: reactive[Reading] = reactive(Reading.NOTHING)

    @dataclass
    class TextTyped(Message):
        """Text was typed."""

        text: str

    def __init__(self) -> None:
        super().__init__(compact=True, select_on_focus=False)

    def watch_reads(self) -> None:
        """Take lines or single keys, as the program reads."""
        self.password = self.reads is Reading.SECRET
        if self.reads.takes_keys:
            self.value = ""

    def on_key(self, event: Key) -> None:
        """Forward the key if the program takes single keys; else Textual's handler, called next, takes it."""
        text = _SEQUENCES.get(event.key) or event.character
        if not self.reads.takes_keys or text is None or event.key in self._ways_out:
            return
        event.stop()
        event.prevent_default()
        self.post_message(self.TextTyped(text))

    @property
    def _ways_out(self) -> Collection[str]:
        actions = keymap_of(self.app).of(action for action in ACTIONS if action.id == "leave_keyboard")
        return [key for action in actions for key in action.key.split(",")]

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Give the line."""
        event.stop()
        self.post_message(self.TextTyped(f"{self.value}\n"))
        self.value = ""

    def action_interrupt(self) -> None:
        """Press ctrl+c in the program's terminal."""
        self.post_message(self.TextTyped(INTERRUPT))

    def action_leave_keyboard(self) -> None:
        """Move the focus to the output, where the other keys work again."""
        self.screen.query_one(ShellOutput).focus()


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
        yield Label(id="asked", markup=False)
        yield ProgramKeyboard()
        yield Prompt()

    def show(self, timeline: Timeline, now: Nanoseconds) -> None:
        """Show the lines of a timeline up to a moment, and a completion that has arrived."""
        self.query_one(ShellOutput).show(timeline, now)
        completed = timeline.completed
        if completed is not None and completed.line != self._completed:
            self._completed = completed.line
            if self.query_one(Prompt).is_as_asked:
                self._offer(completed.start, completed.words)

    def ask(self, asked: KeyboardAsked | None, keymap: Keymap, charset: Charset) -> None:
        """Show the keyboard request of a program; None if no program reads."""
        keyboard = self.query_one(ProgramKeyboard)
        if asked is not None:
            keyboard.reads = asked.reads
            here = keyboard.has_focus
            way = keymap.sign(
                *(Scope.KEYBOARD, "leave_keyboard") if here else (Scope.LESSON, "type"), charset
            )
            what = "each key" if asked.reads.takes_keys else "a line"
            sentence = f"{asked.program} reads {what}: " + (
                f"type here; {way} goes back" if here else f"{way}, and type"
            )
            self.query_one("#asked", Label).update(sentence)
        self.set_class(asked is not None or keyboard.has_focus, "-asked")

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
        """Let the person type a ``ros2`` line."""
        self.query_one(Prompt).focus()

    def focus_keyboard(self) -> None:
        """Let the person type for the program."""
        self.query_one(ProgramKeyboard).focus()
