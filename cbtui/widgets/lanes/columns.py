"""Aggregates intervals column by column, so that the cost of a lane does not depend on their number."""

from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import inf
from operator import attrgetter
from typing import Generic, NamedTuple, Protocol, TypeAlias, TypeVar

from cbtui.widgets.lanes.scale import TimeScale
from sim.trace.events import EntityId
from sim.trace.model import Nanoseconds, Window

SAMPLES_PER_COLUMN = 8
"""Intervals that are examined per column at most; of more, an even sample."""

_START = attrgetter("start")

_SETTLED_AFTER: Nanoseconds = 100_000_000
"""Younger columns are aggregated again: threads of a real-clock run report slightly out of order."""


_LENGTHS_KEPT = 4
"""Number of column lengths for which the settled past is cached."""

_NEWEST = 4
"""The newest columns, in which the run goes on, are aggregated even without budget left."""
_SUMMED_AT_ONCE = 12
"""Columns that are aggregated between two checks of the budget."""


class Interval(Protocol):
    """A call or a wait."""

    @property
    def start(self) -> Nanoseconds:
        """When it began."""

    @property
    def end(self) -> Nanoseconds | None:
        """When it ended; None while it lasts."""

    @property
    def entity(self) -> EntityId:
        """The entity that it belongs to."""


_Key: TypeAlias = tuple[Nanoseconds, EntityId]

I = TypeVar("I", bound=Interval)  # noqa: E741 the one type variable here, for an interval


class LaneColumn(NamedTuple, Generic[I]):
    """The aggregate of one column.

    ``eighths`` is the occupied share, at least 1. ``top`` is the interval with the largest share; ``runs_on``
    tells that it began here and lasts into the next column. ``at_once`` is the number of simultaneous
    intervals.
    """

    eighths: int
    runs_on: bool
    top: I
    at_once: int


class MergedColumns(NamedTuple, Generic[I]):
    """Neighbouring columns with the same top."""

    first: int
    columns: list[LaneColumn[I]]
    top: I

    @property
    def after(self) -> int:
        """The first column that does not belong to it."""
        return self.first + len(self.columns)

    @property
    def is_short(self) -> bool:
        """Whether no column is fully occupied."""
        columns = self.columns
        return columns[0].eighths < 8 and (len(columns) == 1 or all(column.eighths < 8 for column in columns))

    def places(self) -> Iterable[tuple[int, LaneColumn[I]]]:
        """The columns with their places."""
        return enumerate(self.columns, self.first)


class IntervalBudget:
    """The number of intervals that may be examined for one picture; the next picture continues from there."""

    def __init__(self, looks: float = inf) -> None:
        self._left = looks

    @property
    def is_endless(self) -> bool:
        """Whether there is no limit."""
        return self._left == inf

    @property
    def is_used_up(self) -> bool:
        """Whether only the newest columns may still be aggregated."""
        return self._left <= 0

    def use(self, looks: int) -> None:
        """Count examined intervals."""
        self._left -= looks


class _SettledColumns(Generic[I]):
    """The cached columns of one length."""

    def __init__(self) -> None:
        self.edge = 0
        self.settled = 0
        self.kept: dict[int, LaneColumn[I] | None] = {}
        self.lasting: dict[_Key, int] = {}
        self.told: set[_Key] = set()
        self.shown: dict[int, LaneColumn[I] | None] = {}
        """Columns of the last answer that are to be aggregated again."""


class LaneColumns(Generic[I]):
    """The columns of one lane, with a cache of the settled past.

    The cache covers the column lengths shown last, so that zooming out and in again is quick.
    """

    def __init__(self, query: Callable[[Window], Sequence[I]]) -> None:
        self._query = query
        self._per_column = 0
        self._pasts: dict[Nanoseconds, _SettledColumns[I]] = {}
        self.unseen: tuple[int, ...] = ()
        """The columns of the last answer that were never aggregated."""
        self.is_behind = False
        """Whether columns of the last answer are still to be aggregated, perhaps again."""

    def over(
        self, scale: TimeScale, edge: Nanoseconds, ration: IntervalBudget | None = None
    ) -> list[LaneColumn[I] | None]:
        """Aggregate a scale's columns, the newest first; open intervals end at ``edge``.

        Columns beyond the budget are those of the answer before, or None, and listed in ``unseen``.
        """
        past = self._past_of(scale, edge)
        running = self._forget_what_changed(past)
        kept = past.kept
        first = max(scale.first, 0)
        after = min(scale.first + scale.columns, edge // scale.per_column + 1)
        missing = sorted({*range(first, after)}.difference(kept))
        fresh, left = self._newest_of(missing, edge, ration or IntervalBudget())
        late = {number: past.shown[number] for number in missing[:left] if number in past.shown}
        self.unseen = tuple(number - scale.first for number in missing[:left] if number not in late)
        self.is_behind = left > 0
        before, past.settled = past.settled, max(0, (edge - _SETTLED_AFTER) // scale.per_column)
        for number, column in fresh.items():
            if number < past.settled:
                kept[number] = column
                if column is not None and column.top.end is None:
                    key = _key(column.top)
                    past.lasting[key] = min(number, past.lasting.get(key, number))
        past.told = set(running if past.settled == before else self._running_at(past.settled))
        columns = list(map(kept.get, range(scale.first, scale.first + scale.columns)))
        past.shown = late | fresh
        for number, column in past.shown.items():
            columns[number - scale.first] = column
        return columns

    def _past_of(self, scale: TimeScale, edge: Nanoseconds) -> _SettledColumns[I]:
        """The valid cached columns of this length."""
        self._per_column = scale.per_column
        past = self._pasts.pop(scale.per_column, None)
        if past is None or edge < past.edge:
            past = _SettledColumns()
        elif len(past.kept) > 4 * scale.columns:
            shown = range(scale.first, scale.first + scale.columns)
            past.kept = {number: column for number, column in past.kept.items() if number in shown}
        self._pasts[scale.per_column] = past
        past.edge = edge
        if len(self._pasts) > _LENGTHS_KEPT:
            del self._pasts[next(iter(self._pasts))]
        return past

    def _forget_what_changed(self, past: _SettledColumns[I]) -> "dict[_Key, I]":
        """Drop cached columns in which an interval ended, or one began that was unknown then.

        A wait is often reported late: once it is clear that the callback has to wait. Returns what runs where
        the settled past ends.
        """
        running = self._running_at(past.settled)
        ended = [key for key in past.lasting if key not in running or running[key].end is not None]
        changed = [key[0] // self._per_column for key in running.keys() - past.told]
        changed += [past.lasting.pop(key) for key in ended]
        if changed:
            since = min(changed)
            past.shown |= past.kept
            past.kept = {number: column for number, column in past.kept.items() if number < since}
            past.lasting = {key: number for key, number in past.lasting.items() if number < since}
        return running

    def _newest_of(
        self, missing: Sequence[int], edge: Nanoseconds, ration: IntervalBudget
    ) -> tuple[dict[int, LaneColumn[I] | None], int]:
        """Aggregate missing columns from the last backwards; also returns how many are left."""
        fresh: dict[int, LaneColumn[I] | None] = {}
        left = len(missing)
        while left and not (fresh and ration.is_used_up):
            count = left if ration.is_endless else _NEWEST if not fresh else _SUMMED_AT_ONCE
            part = _neighbours(missing[max(0, left - count) : left])
            summed, looks = self._summed(part, edge)
            fresh.update(summed)
            ration.use(looks)
            left -= len(part)
        return fresh, left

    def _summed(
        self, numbers: Sequence[int], edge: Nanoseconds
    ) -> tuple[dict[int, LaneColumn[I] | None], int]:
        """Aggregate neighbouring columns; also returns how many intervals were examined."""
        length = self._per_column
        found = self._query(Window(numbers[0] * length, (numbers[-1] + 1) * length))
        if not found:
            return dict.fromkeys(numbers), 1
        if len(found) <= SAMPLES_PER_COLUMN * len(numbers):
            found = list(found)  # each is made once, not again at every step of a bisection
        looks = len(numbers)
        summed: dict[int, LaneColumn[I] | None] = {}
        low = high = bisect_left(found, numbers[0] * length, key=_START)
        running = list(found[:low])
        for number in numbers:
            window = Window(number * length, (number + 1) * length)
            low, high = high, _first_from(found, window.end, high, high - low)
            step = max(1, -(-(high - low) // SAMPLES_PER_COLUMN))
            begun = [found[place] for place in range(low, high, step)]
            looks += len(running) + len(begun) + (high - low).bit_length()  # the bisection reads, too
            summed[number] = _column(running, begun, step, window, edge) if running or begun else None
            if step > 1:
                running = self._running(window.end)
            else:
                running = [one for one in (*running, *begun) if one.end is None or one.end > window.end]
        return summed, looks

    def _running(self, at: Nanoseconds) -> list[I]:
        return [one for one in self._query(Window(at, at + 1)) if one.start < at]

    def _running_at(self, number: int) -> "dict[_Key, I]":
        return {_key(one): one for one in self._running(number * self._per_column)}


def _key(interval: Interval) -> "_Key":
    return interval.start, interval.entity


class InstantColumns:
    """The columns of one lane with instantaneous events; the settled past is cached."""

    def __init__(self, query: Callable[[Window], Sequence[Nanoseconds]]) -> None:
        self._query = query
        self._per_column = 0
        self._known_to = 0
        self._known_from = 0
        self._marked: set[int] = set()

    def over(self, scale: TimeScale, edge: Nanoseconds) -> list[int]:
        """Return the places of the columns in which something happened up to ``edge``, in order."""
        first, after = scale.first, min(scale.first + scale.columns, edge // scale.per_column + 1)
        apart = first < self._known_from or first > self._known_to
        if scale.per_column != self._per_column or apart or len(self._marked) > 4 * scale.columns:
            self._per_column = scale.per_column
            self._known_from = self._known_to = first
            self._marked = set()
        length = scale.per_column
        fresh = self._query(Window(max(0, self._known_to * length), max(0, after * length)))
        self._marked.update(at // length for at in fresh)
        self._known_to = max(self._known_to, min(after, (edge - _SETTLED_AFTER) // length))
        return sorted([number - first for number in self._marked if first <= number < after])


def _neighbours(numbers: Sequence[int]) -> Sequence[int]:
    """Return the end of ascending column numbers in which none is missing."""
    first = len(numbers) - 1
    while first > 0 and numbers[first - 1] == numbers[first] - 1:
        first -= 1
    return numbers[first:]


def _first_from(found: Sequence[I], at: Nanoseconds, low: int, likely: int) -> int:
    """Return the place of the first interval at or after ``low`` that begins at ``at`` or later.

    ``likely`` is the expected distance: neighbouring columns hold similar numbers, and an interval has to be
    built before it can be examined.
    """
    near = min(len(found), low + 2 * likely + 2)
    place = bisect_left(found, at, lo=low, hi=near, key=_START)
    return place if place < near else bisect_left(found, at, lo=near, key=_START)


def _column(
    running: Sequence[I], begun: Sequence[I], step: int, window: Window, edge: Nanoseconds
) -> LaneColumn[I] | None:
    """Aggregate one column: what runs as it begins, and every ``step``-th interval that begins in it."""
    taken = 0
    longest = -1
    top: I | None = None
    ends: list[Nanoseconds] = []
    at_once = 0
    for place, one in enumerate((*running, *begun)):
        end = edge if one.end is None else one.end
        here = min(end, window.end) - max(one.start, window.start)
        taken += here * (1 if place < len(running) else step)
        if here > longest:
            longest, top = here, one
        ends = [other for other in ends if other > one.start]
        ends.append(end)
        at_once = max(at_once, len(ends))
    if top is None:
        return None
    eighths = min(8, max(1, round(8 * taken / window.length)))
    return LaneColumn(eighths, _runs_on(top, window), top, at_once)


def _runs_on(interval: Interval, window: Window) -> bool:
    ends_later = interval.end is None or interval.end > window.end
    return interval.start > window.start and ends_later


def latest(columns: Sequence[LaneColumn[I] | None], place: int) -> I | None:
    """Return the top of the last column that has one, up to a place."""
    shown = columns[: max(0, place + 1)]
    return next((column.top for column in reversed(shown) if column is not None), None)


def stretches(columns: Sequence[LaneColumn[I] | None]) -> list[MergedColumns[I]]:
    """Join neighbouring columns with the same top."""
    found: list[MergedColumns[I]] = []
    before: I | None = None
    for place, column in enumerate(columns) if any(columns) else ():
        if column is None:
            before = None
            continue
        top = column.top
        if before is not None and top.start == before.start and top.entity == before.entity:
            found[-1].columns.append(column)
        else:
            found.append(MergedColumns(place, [column], top))
        before = top
    return found


def nested_stretches(columns: Sequence[LaneColumn[I] | None]) -> Iterator[tuple[int, int]]:
    """Yield the stretches of columns in which calls lie inside each other: the first, and the one after."""
    first = None
    for place, column in enumerate((*columns, None)):
        if column is not None and column.at_once > 1:
            first = place if first is None else first
        elif first is not None:
            yield first, place
            first = None
