"""The lanes on screen: a widget that draws what its painter paints."""

from collections.abc import Sequence

from textual.geometry import Size
from textual.reactive import reactive

from cbtui.theme import GLYPHS, Charset, Run
from cbtui.widgets.lanes.painter import Painter, Picture, wanted_rows
from cbtui.widgets.painted import Painted
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline


class Lanes(Painted):
    """Threads as lanes, callbacks as bars, waits as hatching; the time axis runs along the bottom.

    Set ``timeline`` again (it may be the same one) when it has grown. ``now`` is the cursor that every pane
    obeys; ``service`` one that is not the learner's and is to have a lane before its first call.
    """

    DEFAULT_CSS = "Lanes { height: auto; }"

    timeline: reactive[Timeline] = reactive(Timeline, always_update=True)
    window: reactive[Window] = reactive(Window(0, 10_000_000_000))
    now: reactive[Nanoseconds] = reactive(0)
    service: reactive[str] = reactive("", layout=True)
    charset: reactive[Charset] = reactive(Charset.BRAILLE)

    _painter = Painter()
    _picture: Picture | None = None
    _wanted = 0

    @property
    def picture(self) -> Picture | None:
        """What was painted last: its lanes, scale and layout tell what lies under a cell."""
        return self._picture

    def rows(self, size: Size) -> Sequence[Sequence[Run]]:
        """Paint the lanes."""
        picture = self._painter.paint(self.timeline, self.window, self.now, size.width, size.height)
        self._picture = picture
        self.border_title = f"Lanes {GLYPHS[self.charset].between} {picture.time_per_column}"
        return picture.rows

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Return how many rows show every lane."""
        return wanted_rows(self.timeline, self.service)

    def watch_timeline(self) -> None:
        """Paint anew, in another height if lanes have come."""
        wanted = wanted_rows(self.timeline, self.service)
        if wanted != self._wanted:
            self._wanted = wanted
            self.refresh(layout=True)
        self.changed()

    def watch_window(self) -> None:
        """Paint another stretch of time."""
        self.changed()

    def watch_now(self) -> None:
        """Paint with the cursor elsewhere."""
        self.changed()

    def watch_service(self) -> None:
        """Give the service a lane."""
        self._painter = Painter(self.charset, self.service)
        self.changed()

    def watch_charset(self) -> None:
        """Paint in other glyphs."""
        self._painter = Painter(self.charset, self.service)
        self.changed()
