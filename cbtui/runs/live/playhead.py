"""The playhead: the cursor and the window of time on screen."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from sim.quantities.nanoseconds import SECOND
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

_MILLISECOND = 1_000_000
_MINUTE = 60 * SECOND
SPANS = (
    *(length * unit * _MILLISECOND for unit in (1, 10, 100, 1000) for length in (1, 2, 5)),
    *(length * SECOND for length in (10, 20, 30)),
    *(length * _MINUTE for length in (1, 2, 5, 10)),
)
"""The lengths of windows that the lanes can show: 1 ms to 10 minutes."""

_STEPS = 10
"""Steps per window for moving the cursor and for panning."""


@dataclass(frozen=True)
class Playhead:
    """The cursor, and the window of time that the lanes show; each can be moved alone.

    The cursor follows the end of the run (``at`` is None) or stands at a past moment, which every pane shows.
    The window ends at the cursor (``start`` is None), or stands where it was moved to.
    """

    span: Nanoseconds = 10 * SECOND
    at: Nanoseconds | None = None
    start: Nanoseconds | None = None
    first: Nanoseconds = 0
    """The earliest moment that can be shown."""

    @property
    def follows(self) -> bool:
        """Whether cursor and window both follow the end of the run."""
        return self.at is None and self.start is None

    def now(self, end: Nanoseconds) -> Nanoseconds:
        """The moment on screen of a run that goes to ``end``."""
        return end if self.at is None else min(self.at, end)

    def window(self, end: Nanoseconds) -> Window:
        """The window on screen; it begins no earlier than ``first``."""
        start = max(self.first, self.now(end) - self.span) if self.start is None else self.start
        return Window(start, start + self.span)

    # the cursor

    def moved(self, steps: int, end: Nanoseconds) -> "Playhead":
        """Move the cursor by tenths of the window, < 0 into the past; past the end it follows the run."""
        return self.moved_to(self.now(end) + steps * self.span // _STEPS, end)

    def moved_to(self, at: Nanoseconds, end: Nanoseconds) -> "Playhead":
        """Put the cursor to a moment, no earlier than ``first``; at or past the end it follows the run.

        The window stays if it shows the cursor.
        """
        if at >= end:
            return self.live()
        at = max(self.first, at)
        return replace(self, at=at, start=self._start_that_shows(at, end))

    def beside(
        self, timelines: Sequence[Timeline], end: Nanoseconds, step: int, stops: Iterable[Nanoseconds] = ()
    ) -> "Playhead":
        """Go to the previous (``step`` < 0) or next event of any run, or one of the other ``stops``.

        Losses in a row count as one event. Before the first one is the beginning; after the last, the
        cursor follows the end.
        """
        now = self.now(end)
        neighbours = [_event_beside(timeline, now, step) for timeline in timelines]
        found = [at for at in neighbours if at is not None]
        found += [at for at in stops if (at > now if step > 0 else at < now)]
        if found:
            return self.moved_to(min(found) if step > 0 else max(found), end)
        return self.live() if step > 0 else self.moved_to(self.first, end)

    def live(self) -> "Playhead":
        """Follow the end again."""
        return replace(self, at=None, start=None)

    def _start_that_shows(self, at: Nanoseconds, end: Nanoseconds) -> Nanoseconds:
        """The start of a window that shows a moment: centred on a distant one, else moved a little.

        At the left edge a margin stays, as the first column may be cut off.
        """
        shown, margin = self.window(end), self.span // (2 * _STEPS)
        if not shown.start - self.span // 2 <= at <= shown.end + self.span // 2:
            return max(self.first, at - self.span // 2)
        if at < shown.start + margin:
            return max(self.first, at - 2 * margin)
        return max(shown.start, at - self.span)

    # the window

    def panned(self, steps: int, end: Nanoseconds) -> "Playhead":
        """Move the window by tenths of itself without the cursor; at the end it follows the run."""
        return self._beginning_at(self.window(end).start + steps * self.span // _STEPS, end)

    def zoomed(self, steps: int, end: Nanoseconds) -> "Playhead":
        """Show a longer (> 0) or shorter window, around the cursor if it is inside, else its middle."""
        place = SPANS.index(self.span) + steps
        other = replace(self, span=SPANS[max(0, min(place, len(SPANS) - 1))])
        if self.follows:
            return other
        shown, fixed = self.window(end), self.now(end)
        if not shown.start <= fixed <= shown.end:
            fixed = shown.start + self.span // 2
        return other._beginning_at(fixed - (fixed - shown.start) * other.span // self.span, end)

    def _beginning_at(self, start: Nanoseconds, end: Nanoseconds) -> "Playhead":
        """A window that begins at ``start``, clamped to the run."""
        latest = max(self.first, end - self.span)
        start = max(self.first, min(start, latest))
        return replace(self, start=None if self.at is None and start == latest else start)


def _event_beside(timeline: Timeline, at: Nanoseconds, step: int) -> Nanoseconds | None:
    """The event before or after a moment; of losses with nothing else between them, the last one."""
    event, other = (timeline.neighbour(at, step, losses) for losses in (True, False))
    if event == other:
        return event
    if step > 0:
        return timeline.neighbour(timeline.end + 1 if other is None else other, -1)
    here, before = (timeline.neighbour(at + 1, -1, losses) for losses in (True, False))
    return other if here == at != before else event
