"""Lanes: threads, callback groups and waiting callbacks over time."""

from cbtui.widgets.lanes.painter import INTERVALS_PER_FRAME, LanePainter
from cbtui.widgets.lanes.picture import LanePicture
from cbtui.widgets.lanes.room import wanted_rows
from cbtui.widgets.lanes.selection import Selection, start_of
from cbtui.widgets.lanes.widget import Lanes

__all__ = [
    "INTERVALS_PER_FRAME",
    "Lanes",
    "LanePainter",
    "LanePicture",
    "Selection",
    "start_of",
    "wanted_rows",
]
