"""Maps columns of the screen to times of a run, and places the labels of the time axis."""

from functools import lru_cache
from typing import NamedTuple

from sim.quantities.nanoseconds import SECOND
from sim.trace.model import Nanoseconds, Window

_MANTISSAS = (10, 12, 15, 18, 20, 22, 25, 30, 35, 40, 45, 50, 60, 70, 80, 90)
_LABEL_STEPS = (1, 2, 5)
_LABEL_ROOM = 8


class TimeScale(NamedTuple):
    """Columns of equal length on a grid that begins at 0 ns; ``first`` is the grid's number of column 0.

    The grid stands still while the window moves over it, so that a picture shifts by whole columns and
    what it showed of the past does not flicker.
    """

    first: int
    per_column: Nanoseconds
    columns: int

    @property
    def window(self) -> Window:
        """The time that the columns show."""
        return Window(self.time_at(0), self.time_at(self.columns))

    def column_of(self, at: Nanoseconds) -> int:
        """Return the column in which a moment lies; it may lie outside the picture."""
        return at // self.per_column - self.first

    def time_at(self, column: int) -> Nanoseconds:
        """Return the moment at which a column begins."""
        return (self.first + column) * self.per_column


def scale_for(window: Window, columns: int) -> TimeScale:
    """Return the scale that shows at least ``window`` in ``columns``, with its end at the right."""
    per_column = nice_column(-(-max(window.length, 1) // columns))
    last = -(-window.end // per_column)
    return TimeScale(last - columns, per_column, columns)


def whole_scale(end: Nanoseconds, columns: int) -> TimeScale:
    """Return the scale that shows a run from its beginning to its end; it seldom changes as the run grows."""
    return TimeScale(0, nice_column(end // columns + 1), columns)


@lru_cache
def nice_column(least: Nanoseconds) -> Nanoseconds:
    """Return the smallest round length of a column that is ``least`` or more."""
    power = 1
    while True:
        for mantissa in _MANTISSAS:
            if mantissa * power >= least * 10 and mantissa * power % 10 == 0:
                return mantissa * power // 10
        power *= 10


def labels(scale: TimeScale) -> list[tuple[int, str]]:
    """Return the axis' labels: the column that each stands at, and the second it names."""
    step = _label_step(scale.per_column * _LABEL_ROOM)
    at = max(0, -(-scale.window.start // step) * step)
    found = []
    while at < scale.window.end:
        found.append((scale.column_of(at), _seconds(at, step)))
        at += step
    return found


def _label_step(least: Nanoseconds) -> Nanoseconds:
    power = 1
    while True:
        for digit in _LABEL_STEPS:
            if digit * power >= least:
                return digit * power
        power *= 10


def _seconds(at: Nanoseconds, step: Nanoseconds) -> str:
    decimals = 0
    while step % (SECOND // 10**decimals) and decimals < 9:
        decimals += 1
    return f"{at / SECOND:.{decimals}f}"
