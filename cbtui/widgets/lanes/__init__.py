"""Lanes: threads, callback groups and waiting callbacks over time."""

from cbtui.widgets.lanes.painter import LOOKS_A_FRAME, Painter, wanted_rows
from cbtui.widgets.lanes.picture import Picture
from cbtui.widgets.lanes.selection import Selection, start_of
from cbtui.widgets.lanes.widget import Lanes

__all__ = ["LOOKS_A_FRAME", "Lanes", "Painter", "Picture", "Selection", "start_of", "wanted_rows"]
