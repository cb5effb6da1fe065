"""Intervals of time in columns, and lanes of them that answer which ones overlap a window or a moment."""

from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator, Sequence
from typing import TypeAlias, TypeVar, overload

from sim.trace.model import Nanoseconds, Window

Row: TypeAlias = int
T = TypeVar("T")

OPEN: Nanoseconds = 2**63 - 1
"""The end of an interval that still lasts: later than any other."""


class Answer(Sequence[T]):
    """The intervals of an answer, each made into a value when it is looked at.

    A picture of an hour asks for a hundred thousand calls and looks at a few hundred.
    """

    __slots__ = ("_make", "_rows")

    def __init__(self, rows: Sequence[Row], make: Callable[[Row], T]) -> None:
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
            return Answer(self._rows[place], self._make)
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
    """Start and end of many intervals; a row number stands for one of them.

    Columns instead of objects, because an hour of a busy run has hundreds of thousands of intervals.
    """

    def __init__(self) -> None:
        self.starts = array("q")
        self.ends = array("q")

    def __len__(self) -> int:
        return len(self.starts)

    def open(self, start: Nanoseconds) -> Row:
        """Begin an interval."""
        self.starts.append(start)
        self.ends.append(OPEN)
        return len(self.starts) - 1

    def close(self, row: Row, end: Nanoseconds) -> None:
        """End an interval, at its start if ``end`` lies before that."""
        self.ends[row] = max(end, self.starts[row])

    def end(self, row: Row) -> Nanoseconds | None:
        """When an interval ended; None while it lasts."""
        end = self.ends[row]
        return None if end == OPEN else end


class Lane:
    """The rows that share something (a thread, an entity, a group), in layers within which none overlap.

    A row goes to the first layer whose last row is over. There are thus never more layers than intervals
    at once (nested calls of a thread, simultaneous calls of a group), and in each layer starts and ends
    both ascend: a query is one bisection a layer, however long a single interval is.
    """

    __slots__ = ("_intervals", "_layers")

    def __init__(self, intervals: Intervals) -> None:
        self._intervals = intervals
        self._layers: list[array[int]] = []

    def add(self, row: Row) -> None:
        """Take in a row. In order of start there are no more layers than needed; any order is right."""
        start = self._intervals.starts[row]
        ends = self._intervals.ends
        for layer in self._layers:
            if ends[layer[-1]] <= start:
                layer.append(row)
                return
        self._layers.append(array("i", (row,)))

    @property
    def layers(self) -> Sequence[Sequence[Row]]:
        """The layers, the one of the outermost intervals first."""
        return self._layers

    def overlapping(self, window: Window) -> list[Row]:
        """Rows that share time with the window, in order of start; instants count if they lie in it."""
        found: list[Row] = []
        for layer in self._layers:
            first = bisect_left(layer, window.start, key=self._intervals.starts.__getitem__)
            after = bisect_left(layer, window.end, lo=first, key=self._intervals.starts.__getitem__)
            if first and self._intervals.ends[layer[first - 1]] > window.start < window.end:
                first -= 1
            found.extend(layer[first:after])
        return self._in_order(found)

    def covering(self, at: Nanoseconds) -> list[Row]:
        """Rows that have begun and not ended when everything that happens at ``at`` has happened."""
        found: list[Row] = []
        for layer in self._layers:
            after = bisect_right(layer, at, key=self._intervals.starts.__getitem__)
            if after and self._intervals.ends[layer[after - 1]] > at:
                found.append(layer[after - 1])
        return self._in_order(found)

    def starting_in(self, window: Window) -> int:
        """How many rows start in the window."""
        key = self._intervals.starts.__getitem__
        return sum(
            bisect_left(layer, window.end, key=key) - bisect_left(layer, window.start, key=key)
            for layer in self._layers
        )

    def starts_beside(self, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """Of every layer the first start after ``at`` (``step`` > 0), or the last one before it."""
        return self._beside(self._intervals.starts, at, step)

    def ends_beside(self, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        """Of every layer the first end after ``at`` (``step`` > 0), or the last one before it."""
        return (end for end in self._beside(self._intervals.ends, at, step) if end != OPEN)

    def _beside(self, column: "array[int]", at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        for layer in self._layers:
            if step > 0:
                place = bisect_right(layer, at, key=column.__getitem__)
            else:
                place = bisect_left(layer, at, key=column.__getitem__) - 1
            if 0 <= place < len(layer):
                yield column[layer[place]]

    def _in_order(self, rows: list[Row]) -> list[Row]:
        if len(self._layers) > 1:
            rows.sort(key=lambda row: (self._intervals.starts[row], row))
        return rows
