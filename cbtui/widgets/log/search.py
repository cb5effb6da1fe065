"""An incremental search of a growing log for the lines that a filter passes."""

from array import array
from bisect import bisect_left
from collections import deque
from collections.abc import Sequence

from cbtui.widgets.log.filter import Filter, LogEvent
from sim.trace.timeline import Timeline

_RECHECKED = 64
"""Searched lines at the end that are checked again, as late lines may be inserted among them."""


class LogSearch:
    """The indices in ``timeline.logs`` of the lines that a filter passes.

    ``go_on`` searches the lines in order, once each; from a late line on, lines are searched again.
    """

    def __init__(self, timeline: Timeline, wanted: Filter) -> None:
        self.timeline = timeline
        self.wanted = wanted
        self._found = array("q")
        self._looked_at = 0
        self._last: deque[LogEvent] = deque(maxlen=_RECHECKED)

    @property
    def places(self) -> Sequence[int]:
        """The indices of the lines, in order."""
        return range(len(self.timeline.logs)) if self.wanted.passes_all else self._found

    def until(self, count: int) -> int:
        """The number of found lines among the first ``count`` of the log."""
        return bisect_left(self.places, count)

    def go_on(self, most: int) -> bool:
        """Search a limited number of further lines; returns whether there are more."""
        if self.wanted.passes_all:
            return False
        logs = self.timeline.logs
        self._go_back_to_late_ones()
        start = self._looked_at
        new = logs[start : start + most]
        self._last.extend(new[-_RECHECKED:])
        self._looked_at += len(new)
        self._found.extend(
            place for place, event in enumerate(new, start) if self.wanted.passes(event, self.timeline)
        )
        return self._looked_at < len(logs)

    def _go_back_to_late_ones(self) -> None:
        """Discard results from the first line on that has moved."""
        first = self._looked_at - len(self._last)
        now = self.timeline.logs[first : self._looked_at]
        pairs = zip(self._last, now, strict=True)
        same = next((number for number, (old, new) in enumerate(pairs) if old != new), None)
        if same is None:
            return
        self._looked_at = first + same if same else 0
        self._last = deque(list(self._last)[:same], _RECHECKED)
        del self._found[bisect_left(self._found, self._looked_at) :]
