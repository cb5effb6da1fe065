"""The map of the robot's world on screen: a widget that draws what its painter paints."""

from collections.abc import Sequence

from textual.geometry import Size
from textual.reactive import reactive

from cbtui.theme import Charset, Run
from cbtui.widgets.arena_painter import ArenaPainter
from cbtui.widgets.painted import Painted
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

__all__ = ["ArenaMap", "ArenaPainter"]


class ArenaMap(Painted):
    """The arena from above at the cursor's time: robot, trail, true scan and the scan the node last saw.

    Set ``timeline`` again (it may be the same one) when it has grown.
    """

    timeline: reactive[Timeline] = reactive(Timeline, always_update=True)
    now: reactive[Nanoseconds] = reactive(0)
    charset: reactive[Charset] = reactive(Charset.BRAILLE)

    def rows(self, size: Size) -> Sequence[Sequence[Run]]:
        """Paint the map."""
        painter = ArenaPainter(self.charset)
        return painter.paint(self.timeline, self.now, size.width, size.height)

    def watch_timeline(self) -> None:
        """Paint what is known now."""
        self.changed()

    def watch_now(self) -> None:
        """Paint another moment."""
        self.changed()

    def watch_charset(self) -> None:
        """Paint in other glyphs."""
        self.changed()
