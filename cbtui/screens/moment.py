"""Asks for a moment of the run."""

import math
from typing import ClassVar

from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.widgets import Input, Static

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.looks.theme import Charset
from cbtui.screens.sized import SizedModal
from cbtui.widgets.key_bar import KeyBar
from sim.durations import timestamp
from sim.trace.model import Nanoseconds
from sim.units import nearest_ns


class MomentScreen(SizedModal[Nanoseconds]):
    """Gives the moment in nanoseconds; None if the person thinks better of it."""

    SCOPE = Scope.MOMENT
    CSS_PATH = "window.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.MOMENT)]

    def __init__(self, now: Nanoseconds, end: Nanoseconds, goes_on: bool, charset: Charset) -> None:
        super().__init__()
        self._now = now
        self._end = end
        self._goes_on = goes_on
        self._charset = charset

    def compose(self) -> ComposeResult:
        """Lay out the question."""
        with Container(classes="window") as window:
            window.border_title = "Go to a moment"
            yield Static(self._question())
            yield Input(f"{self._now / 1e9:.3f}", placeholder="seconds, such as 12.5", compact=True)
            yield Static(id="wrong")
            yield KeyBar(Scope.MOMENT, self._charset)

    def action_go(self) -> None:
        """Take what was typed."""
        self._take(self.query_one(Input).value)

    def action_close(self) -> None:
        """Stay where the person was."""
        self.dismiss(None)

    @on(Input.Submitted)
    def _submit(self, event: Input.Submitted) -> None:
        event.stop()
        self._take(event.value)

    def _take(self, text: str) -> None:
        seconds = seconds_in(text)
        if seconds is None:
            self.query_one("#wrong", Static).update("Give the seconds as a number, such as 12.5.")
        else:
            self.dismiss(nearest_ns(seconds))

    def _question(self) -> str:
        come = f"The run has come to {timestamp(self._end)}."
        if self._goes_on:
            return f"Which second of the run?\n{come}\nIt runs on to a later one, and stands there."
        return f"Which second of the run?\n{come}"


def seconds_in(text: str) -> float | None:
    """The seconds that were typed, with or without an s; None for a negative number or other text."""
    try:
        seconds = float(text.strip().removesuffix("s").strip().replace(",", "."))
    except ValueError:
        return None
    return seconds if math.isfinite(seconds) and 0 <= seconds < 1e9 else None
