"""The highest number of threads that a run needed at once."""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from enum import IntEnum
from operator import itemgetter

from sim.quantities.nanoseconds import SECOND
from sim.trace.incremental import Incremental, run_to_end, split
from sim.trace.model import Nanoseconds, Span, Window
from sim.trace.timeline import Timeline

_SETTLED_AFTER: Nanoseconds = SECOND
"""How far threads of a real-clock run may report out of order; younger calls are checked again."""


class Concurrency:
    """The highest number of threads that ran callbacks at the same moment, up to any moment of a run.

    Checks every call once, and the youngest ones again.
    """

    def __init__(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._settled: Nanoseconds = 0
        self._peaks: list[tuple[Nanoseconds, int]] = []
        self._fresh: list[tuple[Nanoseconds, int]] = []

    def peak(self, at: Nanoseconds) -> int:
        """Return the highest number of threads up to ``at``."""
        self._update()
        peaks = [*self._peaks, *self._fresh]
        place = bisect_right(peaks, at, key=itemgetter(0))
        return peaks[place - 1][1] if place else 0

    def _update(self) -> None:
        end = self._timeline.end
        best = self._peaks[-1][1] if self._peaks else 0
        found = _rises(self._timeline, Window(self._settled, end + 1), best)
        settled = max(self._settled, end - _SETTLED_AFTER)
        self._peaks += [peak for peak in found if peak[0] < settled]
        self._fresh = [peak for peak in found if peak[0] >= settled]
        self._settled = settled


def threads_at_once(timeline: Timeline, window: Window) -> int:
    """Return the highest number of threads that ran callbacks at one moment of the window."""
    return run_to_end(threads_incrementally(timeline, window))


def threads_incrementally(timeline: Timeline, window: Window) -> Incremental[int]:
    """As ``threads_at_once``, step by step."""
    best = 0
    for part in split(window, sum(timeline.calls_of(entity, window) for entity in timeline.entities)):
        rises = _rises(timeline, part, best)
        best = rises[-1][1] if rises else best
        yield
    return best


def _rises(timeline: Timeline, window: Window, best: int) -> list[tuple[Nanoseconds, int]]:
    """Return the times at which the maximum rises above ``best``, each with the new maximum.

    A call that took no time needs a thread besides those of calls around it, also of one that has just got
    its reply from ``Client.call``. Other calls of the same instant may have come before or after it, so they
    do not count.
    """
    running = 0
    rises: list[tuple[Nanoseconds, int]] = []
    for at, change in sorted(_changes(timeline, window)):
        needed = running + (change in _TAKES_THREAD)
        if needed > best:
            best = needed
            rises.append((at, best))
        running += _GROWTH[change]
    return rises


class _Change(IntEnum):
    """Changes of a thread, in the order in which they count at one instant."""

    END = 0
    BEGIN_OF_CALL = 1
    INSTANT = 2
    END_OF_CALL = 3
    BEGIN = 4


_TAKES_THREAD = (_Change.BEGIN_OF_CALL, _Change.INSTANT, _Change.BEGIN)
_GROWTH = {
    _Change.END: -1,
    _Change.BEGIN_OF_CALL: 1,
    _Change.INSTANT: 0,
    _Change.END_OF_CALL: -1,
    _Change.BEGIN: 1,
}


def _changes(timeline: Timeline, window: Window) -> Iterator[tuple[Nanoseconds, _Change]]:
    for thread in timeline.threads:
        replied = {block.end for block in timeline.blocks_on(thread, window)}
        for start, end in _busy(timeline.spans_on(thread, window), window):
            if start == end and end not in replied:
                yield start, _Change.INSTANT
            else:
                yield start, _Change.BEGIN_OF_CALL if start == end else _Change.BEGIN
                yield end, _Change.END_OF_CALL if end in replied else _Change.END


def _busy(spans: Sequence[Span], window: Window) -> list[tuple[Nanoseconds, Nanoseconds]]:
    """Return a thread's busy intervals; nested and adjacent calls are merged."""
    intervals: list[tuple[Nanoseconds, Nanoseconds]] = []
    for span in spans:
        end = span.end_at(window.end)
        if intervals and span.start <= intervals[-1][1]:
            intervals[-1] = (intervals[-1][0], max(end, intervals[-1][1]))
        else:
            intervals.append((span.start, end))
    return intervals
