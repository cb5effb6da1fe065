"""How many threads of a run were ever needed at once."""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from enum import IntEnum
from operator import itemgetter

from sim.trace.incremental import Incremental, run_to_end, split
from sim.trace.model import Nanoseconds, Span, Window
from sim.trace.timeline import Timeline
from sim.units import SECOND

_SETTLED_AFTER: Nanoseconds = SECOND
"""How long threads of a real-clock run may report out of order; younger calls are looked at again."""


class Concurrency:
    """The highest number of threads that ran callbacks at the same moment, up to any moment of a run.

    Looks at every call once, and at the youngest ones again.
    """

    def __init__(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._settled: Nanoseconds = 0
        self._peaks: list[tuple[Nanoseconds, int]] = []
        self._fresh: list[tuple[Nanoseconds, int]] = []

    def peak(self, at: Nanoseconds) -> int:
        """Return the most threads at once until ``at``."""
        self._look()
        peaks = [*self._peaks, *self._fresh]
        place = bisect_right(peaks, at, key=itemgetter(0))
        return peaks[place - 1][1] if place else 0

    def _look(self) -> None:
        end = self._timeline.end
        best = self._peaks[-1][1] if self._peaks else 0
        found = _rises(self._timeline, Window(self._settled, end + 1), best)
        settled = max(self._settled, end - _SETTLED_AFTER)
        self._peaks += [peak for peak in found if peak[0] < settled]
        self._fresh = [peak for peak in found if peak[0] >= settled]
        self._settled = settled


def threads_at_once(timeline: Timeline, window: Window) -> int:
    """Return the most threads that ran callbacks at one moment of the window."""
    return run_to_end(threads_incrementally(timeline, window))


def threads_incrementally(timeline: Timeline, window: Window) -> Incremental[int]:
    """The same in small pieces."""
    best = 0
    for part in split(window, sum(timeline.calls_of(entity, window) for entity in timeline.entities)):
        rises = _rises(timeline, part, best)
        best = rises[-1][1] if rises else best
        yield
    return best


def _rises(timeline: Timeline, window: Window, best: int) -> list[tuple[Nanoseconds, int]]:
    """Return when more than ``best`` threads ran at once, and how many, each time a record is broken.

    A call that took no time needs a thread beside those that began before it and last longer. What else
    happened at the same instant may have come before or after it, so it is not counted as at once.
    """
    running = 0
    rises: list[tuple[Nanoseconds, int]] = []
    for at, step in sorted(_steps(timeline, window)):
        needed = running + (step is not _Step.END)
        if needed > best:
            best = needed
            rises.append((at, best))
        running += {_Step.END: -1, _Step.INSTANT: 0, _Step.BEGIN: 1}[step]
    return rises


class _Step(IntEnum):
    """What happens on a thread, in the order in which it counts at one instant."""

    END = 0
    INSTANT = 1
    BEGIN = 2


def _steps(timeline: Timeline, window: Window) -> Iterator[tuple[Nanoseconds, _Step]]:
    for thread in timeline.threads:
        for start, end in _busy(timeline.spans_on(thread, window), window):
            if start == end:
                yield start, _Step.INSTANT
            else:
                yield start, _Step.BEGIN
                yield end, _Step.END


def _busy(spans: Sequence[Span], window: Window) -> list[tuple[Nanoseconds, Nanoseconds]]:
    """Return the stretches in which a thread ran anything, nested and following calls joined."""
    stretches: list[tuple[Nanoseconds, Nanoseconds]] = []
    for span in spans:
        end = span.end_at(window.end)
        if stretches and span.start <= stretches[-1][1]:
            stretches[-1] = (stretches[-1][0], max(end, stretches[-1][1]))
        else:
            stretches.append((span.start, end))
    return stretches
