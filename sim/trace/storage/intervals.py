"""Intervals of time in a table, and lanes that find those in a window or at a moment."""

from collections.abc import Iterator, Sequence
from typing import TypeAlias

from sim.trace.model import Nanoseconds, Window
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import IntegerTable

RowId: TypeAlias = int

OPEN: Nanoseconds = 2**63 - 1
"""The end of an open interval: later than any other."""


class Intervals:
    """A table of intervals: start, end and further columns; a row number identifies an interval.

    A table instead of objects, because an hour of a busy run has hundreds of thousands of intervals.
    """

    START, END = range(2)

    def __init__(self, spill: SpillFile, more: int = 0) -> None:
        self.spill = spill
        self.table = IntegerTable(spill, 2 + more)

    def __len__(self) -> int:
        return len(self.table)

    def open(self, start: Nanoseconds, *more: int) -> RowId:
        """Start an interval; ``more`` are the further cells."""
        return self.table.append([start, OPEN, *more])

    def close(self, row: RowId, end: Nanoseconds) -> None:
        """End an interval, at its start if ``end`` lies before that."""
        self.table.change(row, self.END, max(end, self.started_at(row)))

    def started_at(self, row: RowId) -> Nanoseconds:
        """The start of an interval."""
        return self.table.cell(row, self.START)

    def ended_at(self, row: RowId) -> Nanoseconds:
        """The end of an interval; ``OPEN`` while it lasts."""
        return self.table.cell(row, self.END)


def end_or_none(end: Nanoseconds) -> Nanoseconds | None:
    """The end of an interval; None while it lasts."""
    return None if end == OPEN else end


class Layer(IntegerTable):
    """Intervals of a lane that do not overlap: starts and row numbers, in order."""

    __slots__ = ()

    START, ROW = range(2)

    def __init__(self, spill: SpillFile) -> None:
        super().__init__(spill, 2)

    def start(self, place: int) -> Nanoseconds:
        """The start of the interval at a place."""
        return self.cell(place, self.START)

    def interval(self, place: int) -> RowId:
        """The row of the interval at a place."""
        return self.cell(place, self.ROW)

    def intervals(self, places: range) -> Sequence[RowId]:
        """The rows of the intervals at consecutive places."""
        return self.column(self.ROW, places)


class IntervalLane:
    """The rows of a thread, an entity or a group, in layers within which none overlap.

    A row goes to the first layer whose last row has ended. So there are never more layers than simultaneous
    intervals (nested calls of a thread, parallel calls of a group), and starts and ends ascend in each layer:
    a query is one bisection per layer.
    """

    __slots__ = ("_intervals", "layers")

    def __init__(self, intervals: Intervals) -> None:
        self._intervals = intervals
        self.layers: list[Layer] = []
        """The layers, the outermost intervals first."""

    def add(self, row: RowId) -> Layer:
        """Add a row and return its layer.

        Rows may come in any order; in order of start they need the fewest layers.
        """
        cell = self._intervals.table.cell
        start = cell(row, Intervals.START)
        for layer in self.layers:
            if cell(layer.last(Layer.ROW), Intervals.END) <= start:
                layer.append([start, row])
                return layer
        layer = Layer(self._intervals.spill)
        layer.append([start, row])
        self.layers.append(layer)
        return layer

    def overlapping(self, window: Window) -> Sequence[RowId]:
        """Rows that overlap the window, in order of start; instants count if they lie in it."""
        return self._in_order([layer.intervals(self._places(layer, window)) for layer in self.layers])

    def starting(self, window: Window) -> Sequence[RowId]:
        """Rows that start in the window, in order of start."""
        return self._in_order(
            [
                layer.intervals(range(layer.before(window.start), layer.before(window.end)))
                for layer in self.layers
            ]
        )

    def covering(self, at: Nanoseconds) -> list[RowId]:
        """Rows that are open after all events at ``at``."""
        found: list[RowId] = []
        for layer in self.layers:
            after = layer.until(at)
            if after:
                row = layer.interval(after - 1)
                if self._intervals.ended_at(row) > at:
                    found.append(row)
        return sorted(found, key=self._order) if len(found) > 1 else found

    def starting_in(self, window: Window) -> int:
        """The number of rows that start in the window."""
        return sum(layer.before(window.end) - layer.before(window.start) for layer in self.layers)

    def starts_beside(self, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """Of each layer the first start after ``at`` (``step`` > 0), or the last one before it."""
        for layer in self.layers:
            place = layer.until(at) if step > 0 else layer.before(at) - 1
            if 0 <= place < len(layer):
                yield layer.start(place)

    def ends_beside(self, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """Of each layer the first end after ``at`` (``step`` > 0), or the last one before it."""
        for layer in self.layers:
            # Ends ascend with starts: it is the end of the last interval to start, or its neighbour's.
            nearest = layer.until(at) - 1 if step > 0 else layer.before(at) - 1
            for place in (nearest, nearest + step):
                if 0 <= place < len(layer):
                    end = self._intervals.ended_at(layer.interval(place))
                    if end != OPEN and (end - at) * step > 0:
                        yield end
                        break

    def _places(self, layer: Layer, window: Window) -> range:
        first, after = layer.before(window.start), layer.before(window.end)
        if first and window.start < window.end:
            earlier = self._intervals.ended_at(layer.interval(first - 1))
            if earlier > window.start:
                first -= 1
        return range(first, max(first, after))

    def _in_order(self, found: list[Sequence[RowId]]) -> Sequence[RowId]:
        if len(found) == 1:
            return found[0]
        rows = [row for rows in found for row in rows]
        rows.sort(key=self._order)
        return rows

    def _order(self, row: RowId) -> tuple[Nanoseconds, RowId]:
        return self._intervals.started_at(row), row
