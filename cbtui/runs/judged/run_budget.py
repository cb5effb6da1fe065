"""What a run that is judged may take before it is ended as hopeless: real time, and room for text."""

from collections.abc import Callable, Iterable
from time import monotonic

from cbtui.runs.judged.checking import LIMIT, MOST_TEXT, text_in, took_too_long, wrote_too_much
from sim.trace.events import AnyEvent
from sim.trace.timeline import Timeline


class RunBudget:
    """Counts what one run takes. ``limit`` is in real seconds, which ``clock`` tells."""

    def __init__(self, limit: float = LIMIT, clock: Callable[[], float] = monotonic) -> None:
        self._limit = limit
        self._clock = clock
        self._at = clock()
        self._taken = 0.0
        self._text = 0

    def write(self, events: Iterable[AnyEvent]) -> None:
        """Count what was written."""
        self._text += text_in(events)

    def pass_time(self) -> None:
        """Count the time since one of the two was last told of."""
        now = self._clock()
        self._taken += now - self._at
        self._at = now

    def rest(self) -> None:
        """Do not count it: the run stands, or goes slowly because it is to be watched."""
        self._at = self._clock()

    def spent(self, timeline: Timeline, name: str) -> str | None:
        """Say of what the run, with a file of that name, has taken too much; None if it has not."""
        if self._text > MOST_TEXT:
            return wrote_too_much(timeline, name)
        return took_too_long(timeline, name, self._limit) if self._taken > self._limit else None
