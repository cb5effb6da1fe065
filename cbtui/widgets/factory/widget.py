"""The factory on screen: a widget that draws what its painter paints."""

from collections.abc import Sequence

from textual.geometry import Size
from textual.reactive import reactive

from cbtui.looks.theme import Charset, TextRun
from cbtui.widgets.factory.painter import GLANCE, FactoryPainter
from cbtui.widgets.painted_widget import PaintedWidget
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline


class FactoryView(PaintedWidget):
    """Threads as workers, callback groups as areas with seats, queues as belts, at the cursor's time.

    Set ``timeline`` again (it may be the same one) when it has grown. ``glance`` is how many nanoseconds of
    the run a worker is seen walking to an area or back: a moment on the screen times the run's speed.
    """

    BORDER_TITLE = "3 Factory"

    timeline: reactive[Timeline] = reactive(Timeline, always_update=True, repaint=False)
    now: reactive[Nanoseconds] = reactive(0, repaint=False)
    glance: reactive[Nanoseconds] = reactive(GLANCE, repaint=False)
    charset: reactive[Charset] = reactive(Charset.BRAILLE, repaint=False)

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the factory."""
        painter = FactoryPainter(self.charset)
        return painter.paint(self.timeline, self.now, size.width, size.height, self.glance)

    def show(self, timeline: Timeline, now: Nanoseconds, speed: float) -> None:
        """Show a moment of a run that goes ``speed`` times as fast as the person's time."""
        self.now, self.timeline = now, timeline
        self.glance = round(GLANCE * speed)

    def watch_timeline(self) -> None:
        """Paint what is known now."""
        self.changed()

    def watch_now(self) -> None:
        """Paint another moment."""
        self.changed()

    def watch_glance(self) -> None:
        """Let workers walk faster or more slowly."""
        self.changed()

    def watch_charset(self) -> None:
        """Paint in other glyphs."""
        self.changed()
