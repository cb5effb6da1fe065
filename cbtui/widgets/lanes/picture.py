"""Painted lanes as a value, and the layout of their width."""

from dataclasses import dataclass

from cbtui.looks.theme import TextRun
from cbtui.widgets.lanes.rows import Lane
from cbtui.widgets.lanes.scale import TimeScale
from sim.quantities.durations import duration

LEAST_WIDTH = 20
"""Columns below which lanes are left blank."""


@dataclass(frozen=True, slots=True)
class LaneLayout:
    """The layout of a width: names at the left, lanes, statuses at the right, a frame between."""

    names: int
    columns: int
    statuses: int


def layout_for(width: int) -> LaneLayout:
    """Return the layout of a width of ``LEAST_WIDTH`` or more; a narrow one has short names and statuses."""
    for least, names, statuses in ((120, 23, 25), (72, 12, 16), (48, 10, 10), (LEAST_WIDTH, 6, 0)):
        if width >= least:
            return LaneLayout(names, width - names - statuses - 2, statuses)
    raise ValueError(f"lanes need {LEAST_WIDTH} columns, got {width}")


@dataclass(frozen=True, slots=True)
class LanePicture:
    """Painted lanes, then the axis, and the overview of the whole run where there is one.

    ``lanes`` are those of the first ``rows``, of each row one; a lane may have two. A picture that is not
    ``complete`` has faint points in the columns beyond its budget. ``overview`` is the scale of the overview.
    """

    rows: tuple[tuple[TextRun, ...], ...]
    lanes: tuple[Lane, ...]
    layout: LaneLayout
    scale: TimeScale
    complete: bool = True
    overview: TimeScale | None = None

    @property
    def time_per_column(self) -> str:
        """The scale in words, such as ``200 ms/col``."""
        return f"{duration(self.scale.per_column)}/col"
