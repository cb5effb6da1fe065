"""Which moment and which stretch of a run is on screen."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline
from sim.units import SECOND

_MILLISECOND = 1_000_000
_MINUTE = 60 * SECOND
SPANS = (
    *(length * unit * _MILLISECOND for unit in (1, 10, 100, 1000) for length in (1, 2, 5)),
    *(length * SECOND for length in (10, 20, 30)),
    *(length * _MINUTE for length in (1, 2, 5, 10)),
)
"""The stretches of time that the lanes can show: 1 ms to 10 minutes."""

_STEPS = 10
"""Into how many steps a stretch is divided for moving the cursor and for panning."""


@dataclass(frozen=True)
class Playhead:
    """The cursor, and the stretch of time around which the lanes are drawn; each can be moved alone.

    The cursor follows the end of the run (``at`` None), or stands where the person looked back to: every pane
    shows that moment. The stretch ends at the cursor (``start`` None), or begins where it was moved to and
    stands still while the run goes on.
    """

    span: Nanoseconds = 10 * SECOND
    at: Nanoseconds | None = None
    start: Nanoseconds | None = None

    @property
    def follows(self) -> bool:
        """Whether cursor and stretch both go with the end of the run."""
        return self.at is None and self.start is None

    def now(self, end: Nanoseconds) -> Nanoseconds:
        """The moment on screen, in a run that has come to ``end``."""
        return end if self.at is None else min(self.at, end)

    def window(self, end: Nanoseconds) -> Window:
        """The stretch on screen; one that ends at a cursor younger than it is long begins at 0."""
        start = max(0, self.now(end) - self.span) if self.start is None else self.start
        return Window(start, start + self.span)

    # the cursor

    def moved(self, steps: int, end: Nanoseconds) -> "Playhead":
        """Move the cursor by steps of a tenth of the stretch, < 0 into the past; past the end is live."""
        return self.sought(self.now(end) + steps * self.span // _STEPS, end)

    def sought(self, at: Nanoseconds, end: Nanoseconds) -> "Playhead":
        """Put the cursor to a moment, the beginning if it lies before that; at or past the end is live again.

        The stretch stands still as long as it shows the cursor.
        """
        if at >= end:
            return self.live()
        at = max(0, at)
        return replace(self, at=at, start=self._start_that_shows(at, end))

    def beside(self, timelines: Sequence[Timeline], end: Nanoseconds, step: int) -> "Playhead":
        """Go to the event before (``step`` < 0) or after, of any of the runs; after the last is live."""
        neighbours = [timeline.neighbour(self.now(end), None, step) for timeline in timelines]
        found = [at for at in neighbours if at is not None]
        if found:
            return self.sought(min(found) if step > 0 else max(found), end)
        return self.live() if step > 0 else self

    def live(self) -> "Playhead":
        """Follow the end again."""
        return replace(self, at=None, start=None)

    def _start_that_shows(self, at: Nanoseconds, end: Nanoseconds) -> Nanoseconds:
        """Where the stretch has to begin: with a far moment in its middle, else as near as it stands.

        At its left edge some of what was before stays on screen: the first column may be cut off.
        """
        shown, margin = self.window(end), self.span // (2 * _STEPS)
        if not shown.start - self.span // 2 <= at <= shown.end + self.span // 2:
            return max(0, at - self.span // 2)
        if at < shown.start + margin:
            return max(0, at - 2 * margin)
        return max(shown.start, at - self.span)

    # the stretch

    def panned(self, steps: int, end: Nanoseconds) -> "Playhead":
        """Move the stretch by steps of a tenth of itself and leave the cursor; at the end it follows that."""
        return self._beginning_at(self.window(end).start + steps * self.span // _STEPS, end)

    def zoomed(self, steps: int, end: Nanoseconds) -> "Playhead":
        """Show a longer (> 0) or shorter stretch: around the cursor, or around its middle without one."""
        place = SPANS.index(self.span) + steps
        other = replace(self, span=SPANS[max(0, min(place, len(SPANS) - 1))])
        if self.follows:
            return other
        shown, fixed = self.window(end), self.now(end)
        if not shown.start <= fixed <= shown.end:
            fixed = shown.start + self.span // 2
        return other._beginning_at(fixed - (fixed - shown.start) * other.span // self.span, end)

    def _beginning_at(self, start: Nanoseconds, end: Nanoseconds) -> "Playhead":
        """The stretch from ``start``, as near to it as the run's beginning and end allow."""
        latest = max(0, end - self.span)
        start = max(0, min(start, latest))
        return replace(self, start=None if self.at is None and start == latest else start)
