"""The number of rows that lanes can use, and the distribution of spare rows."""

from collections.abc import Sequence

from cbtui.widgets.lanes.rows import Lane, ThreadLane, all_lanes
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

ROOMY_FROM = 120
"""The smallest width in which threads have a second row, and the whole run an overview."""


def wanted_rows(
    timeline: Timeline,
    service: str = "",
    width: int = 0,
    window: Window | None = None,
    whole: Nanoseconds = 0,
) -> int:
    """Return the number of rows that show every lane and the axis; ``service`` as for the painter.

    With the ``width`` and the ``window`` of the picture the further rows of threads and the overview are
    counted, too.
    """
    lanes = all_lanes(timeline, service)
    more = sum(_rows_inside(lane, timeline) for lane in lanes) if width >= ROOMY_FROM else 0
    overview = whole > 0 or (window is not None and has_overview(timeline, width, window))
    return len(lanes) + 1 + more + overview


def _rows_inside(lane: Lane, timeline: Timeline) -> int:
    """The further rows that a lane can use: one for the lines of its calls, one for the calls inside them."""
    if not isinstance(lane, ThreadLane):
        return 0
    return timeline.has_positions(lane.thread.id) + timeline.has_nested(lane.thread.id)


def rows_granted(lanes: Sequence[Lane], timeline: Timeline, spare: int) -> dict[Lane, int]:
    """Distribute spare rows: to every thread all it can use, else one row, else none."""
    worth = {lane: _rows_inside(lane, timeline) for lane in lanes}
    shares = (worth, {lane: min(1, rows) for lane, rows in worth.items()})
    return next((share for share in shares if sum(share.values()) <= spare), dict.fromkeys(lanes, 0))


def has_overview(timeline: Timeline, width: int, window: Window) -> bool:
    """Whether a picture gets an overview: there is more of the run than it shows."""
    return width >= ROOMY_FROM and (window.start > 0 or timeline.end > window.end)
