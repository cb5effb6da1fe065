"""The budget of a judged run: real time, and amount of text."""

from collections.abc import Callable, Iterable
from time import monotonic

from cbtui.runs.judged.checking import LIMIT, MOST_TEXT, text_in, took_too_long, wrote_too_much
from sim.trace.events import AnyEvent
from sim.trace.timeline import Timeline


class RunBudget:
    """Counts the real time and text of one run. ``limit`` and ``clock`` are in real seconds."""

    def __init__(self, limit: float = LIMIT, clock: Callable[[], float] = monotonic) -> None:
        self._limit = limit
        self._clock = clock
        self._at = clock()
        self._taken = 0.0
        self._text = 0

    def write(self, events: Iterable[AnyEvent]) -> None:
        """Count the text of the events."""
        self._text += text_in(events)

    def pass_time(self) -> None:
        """Count the time since the last ``pass_time`` or ``rest``."""
        now = self._clock()
        self._taken += now - self._at
        self._at = now

    def rest(self) -> None:
        """Skip the time since then: the run is paused, or slowed down for the viewer."""
        self._at = self._clock()

    def spent(self, timeline: Timeline, name: str) -> str | None:
        """Return a sentence on the exhausted limit, naming the file; None while both limits hold."""
        if self._text > MOST_TEXT:
            return wrote_too_much(timeline, name)
        return took_too_long(timeline, name, self._limit) if self._taken > self._limit else None
