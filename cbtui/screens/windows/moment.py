"""The window that asks for a moment of the run."""

import math

from textual.app import ComposeResult
from textual.widgets import Static

from cbtui.keys.action import Scope
from cbtui.looks.theme import Charset
from cbtui.screens.windows.typed_line import LineScreen, TypedLine
from sim.quantities.durations import timestamp
from sim.quantities.nanoseconds import nearest_ns
from sim.trace.model import Nanoseconds


class MomentScreen(LineScreen[Nanoseconds]):
    """Its result is the moment in nanoseconds; None if it was closed."""

    SCOPE = Scope.MOMENT
    heading = "Go to a moment"

    def __init__(self, now: Nanoseconds, end: Nanoseconds, goes_on: bool, charset: Charset) -> None:
        super().__init__(charset)
        self._now = now
        self._end = end
        self._goes_on = goes_on

    def content(self) -> ComposeResult:
        """Lay out the question."""
        yield Static(self._question())
        line = TypedLine(f"{self._now / 1e9:.3f}", self._take, "seconds, such as 12.5")
        yield line
        yield line.refusal

    def _take(self, text: str) -> None:
        seconds = seconds_in(text)
        if seconds is None:
            raise ValueError("Give the seconds as a number, such as 12.5")
        self.dismiss(nearest_ns(seconds))

    def _question(self) -> str:
        come = f"The run is at {timestamp(self._end)}."
        if self._goes_on:
            return f"Which second of the run?\n{come}\nFor a later one it runs on, and pauses there."
        return f"Which second of the run?\n{come}"


def seconds_in(text: str) -> float | None:
    """Parse seconds, with or without an s; None for negative numbers and other text."""
    try:
        seconds = float(text.strip().removesuffix("s").strip().replace(",", "."))
    except ValueError:
        return None
    return seconds if math.isfinite(seconds) and 0 <= seconds < 1e9 else None
