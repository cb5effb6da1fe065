"""Which moment and which stretch of a run is on screen."""

from dataclasses import dataclass, replace

from sim.trace.events import EntityId
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

_SECOND = 1_000_000_000
SPANS = tuple(
    length * unit
    for unit in (_SECOND // 1000, _SECOND // 100, _SECOND // 10, _SECOND, 10 * _SECOND, 100 * _SECOND)
    for length in (1, 2, 5)
)
"""The stretches of time that the lanes can show: 1 ms to 500 s."""


@dataclass(frozen=True)
class Playhead:
    """Follows the end of a run (``at`` None), or stands where the person looked back to."""

    span: Nanoseconds = 10 * _SECOND
    at: Nanoseconds | None = None

    def now(self, end: Nanoseconds) -> Nanoseconds:
        """The moment on screen, in a run that has come to ``end``."""
        return end if self.at is None else min(self.at, end)

    def window(self, end: Nanoseconds) -> Window:
        """The stretch on screen: it ends now, and while the run is younger than that begins at 0."""
        last = max(self.now(end), self.span)
        return Window(last - self.span, last)

    def moved(self, steps: int, end: Nanoseconds) -> "Playhead":
        """Go steps of a tenth of the stretch into the past (< 0) or back; past the end is live again."""
        return self.sought(self.now(end) + steps * self.span // 10, end)

    def sought(self, at: Nanoseconds, end: Nanoseconds) -> "Playhead":
        """Go to a moment, the beginning if it lies before it; at or past the end is live again."""
        return replace(self, at=None if at >= end else max(0, at))

    def beside(self, timeline: Timeline, step: int, entity: EntityId | None = None) -> "Playhead":
        """Go to the event before (``step`` < 0) or after, of an entity or of any; after the last is live."""
        found = timeline.neighbour(self.now(timeline.end), entity, step)
        if found is not None:
            return self.sought(found, timeline.end)
        return self.live() if step > 0 else self

    def live(self) -> "Playhead":
        """Follow the end again."""
        return replace(self, at=None)

    def zoomed(self, steps: int) -> "Playhead":
        """Show a longer (> 0) or shorter stretch."""
        place = SPANS.index(self.span) + steps
        return replace(self, span=SPANS[max(0, min(place, len(SPANS) - 1))])
