"""Intervals of time in a table, and lanes of them that answer which ones overlap a window or a moment."""

from collections.abc import Callable, Iterator, Sequence
from typing import TypeAlias, TypeVar, overload

from sim.trace.model import Nanoseconds, Window
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import Table

RowId: TypeAlias = int
T = TypeVar("T")

OPEN: Nanoseconds = 2**63 - 1
"""The end of an interval that still lasts: later than any other."""


class LazySequence(Sequence[T]):
    """The intervals of an answer, each made into a value when it is looked at.

    A picture of an hour asks for a hundred thousand calls and looks at a few hundred.
    """

    __slots__ = ("_make", "_rows")

    def __init__(self, rows: Sequence[RowId], make: Callable[[RowId], T]) -> None:
        self._rows = rows
        self._make = make

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, place: int) -> T: ...
    @overload
    def __getitem__(self, place: slice) -> Sequence[T]: ...
    def __getitem__(self, place: int | slice) -> T | Sequence[T]:
        if isinstance(place, slice):
            return LazySequence(self._rows[place], self._make)
        return self._make(self._rows[place])

    def __iter__(self) -> Iterator[T]:
        return map(self._make, self._rows)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Sequence):
            return len(self) == len(other) and all(mine == its for mine, its in zip(self, other, strict=True))
        return NotImplemented

    __hash__ = None  # type: ignore[assignment]  # like a list

    def __repr__(self) -> str:
        return repr(list(self))


class Intervals:
    """Start and end of many intervals, and what else is known of each; a row number stands for one of them.

    A table instead of objects, because an hour of a busy run has hundreds of thousands of intervals.
    """

    START, END = range(2)

    def __init__(self, spill: SpillFile, more: int = 0) -> None:
        self.spill = spill
        self.table = Table(spill, 2 + more)

    def __len__(self) -> int:
        return len(self.table)

    def open(self, start: Nanoseconds, *more: int) -> RowId:
        """Begin an interval; ``more`` are the cells behind start and end."""
        return self.table.append([start, OPEN, *more])

    def close(self, row: RowId, end: Nanoseconds) -> None:
        """End an interval, at its start if ``end`` lies before that."""
        self.table.change(row, self.END, max(end, self.started_at(row)))

    def started_at(self, row: RowId) -> Nanoseconds:
        """When an interval began."""
        return self.table.cell(row, self.START)

    def ended_at(self, row: RowId) -> Nanoseconds:
        """When an interval ended; ``OPEN`` while it lasts."""
        return self.table.cell(row, self.END)


def end_or_none(end: Nanoseconds) -> Nanoseconds | None:
    """The end of an interval; None while it lasts."""
    return None if end == OPEN else end


class Layer(Table):
    """Intervals of a lane of which none overlap: the starts and the rows, in order."""

    __slots__ = ()

    START, ROW = range(2)

    def __init__(self, spill: SpillFile) -> None:
        super().__init__(spill, 2)

    def start(self, place: int) -> Nanoseconds:
        """When the interval at a place begins."""
        return self.cell(place, self.START)

    def interval(self, place: int) -> RowId:
        """The row of the interval at a place."""
        return self.cell(place, self.ROW)

    def intervals(self, places: range) -> Sequence[RowId]:
        """The rows of the intervals at places that follow each other."""
        return self.column(self.ROW, places)


class Lane:
    """The rows that share something (a thread, an entity, a group), in layers within which none overlap.

    A row goes to the first layer whose last row is over. There are thus never more layers than intervals
    at once (nested calls of a thread, simultaneous calls of a group), and in each layer starts and ends
    both ascend: a query is one bisection a layer, however long a single interval is.
    """

    __slots__ = ("_intervals", "_layers")

    def __init__(self, intervals: Intervals) -> None:
        self._intervals = intervals
        self._layers: list[Layer] = []

    def add(self, row: RowId) -> Layer:
        """Take in a row; tells where it went.

        In order of start there are no more layers than needed; any order is right.
        """
        cell = self._intervals.table.cell
        start = cell(row, Intervals.START)
        for layer in self._layers:
            if cell(layer.last(Layer.ROW), Intervals.END) <= start:
                layer.append([start, row])
                return layer
        layer = Layer(self._intervals.spill)
        layer.append([start, row])
        self._layers.append(layer)
        return layer

    @property
    def layers(self) -> Sequence[Layer]:
        """The layers, the one of the outermost intervals first."""
        return self._layers

    def overlapping(self, window: Window) -> Sequence[RowId]:
        """Rows that share time with the window, in order of start; instants count if they lie in it."""
        return self._in_order([layer.intervals(self._places(layer, window)) for layer in self._layers])

    def starting(self, window: Window) -> Sequence[RowId]:
        """Rows that start in the window, in order of start."""
        return self._in_order(
            [
                layer.intervals(range(layer.before(window.start), layer.before(window.end)))
                for layer in self._layers
            ]
        )

    def covering(self, at: Nanoseconds) -> list[RowId]:
        """Rows that have begun and not ended when everything that happens at ``at`` has happened."""
        found: list[RowId] = []
        for layer in self._layers:
            after = layer.until(at)
            if after:
                row = layer.interval(after - 1)
                if self._intervals.ended_at(row) > at:
                    found.append(row)
        return sorted(found, key=self._order) if len(found) > 1 else found

    def starting_in(self, window: Window) -> int:
        """How many rows start in the window."""
        return sum(layer.before(window.end) - layer.before(window.start) for layer in self._layers)

    def starts_beside(self, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """Of every layer the first start after ``at`` (``step`` > 0), or the last one before it."""
        for layer in self._layers:
            place = layer.until(at) if step > 0 else layer.before(at) - 1
            if 0 <= place < len(layer):
                yield layer.start(place)

    def ends_beside(self, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """Of every layer the first end after ``at`` (``step`` > 0), or the last one before it."""
        for layer in self._layers:
            # Ends ascend as starts do: the one looked for is that of the last to begin, or its neighbour's.
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
