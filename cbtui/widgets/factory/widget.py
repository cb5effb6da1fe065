"""The widget of the factory: draws what its painter paints."""

from collections.abc import Sequence

from textual.geometry import Size
from textual.reactive import reactive

from cbtui.looks.theme import Charset, TextRun
from cbtui.widgets.factory.painter import GLANCE, FactoryPainter
from cbtui.widgets.painted_widget import PaintedWidget, painted
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline


class FactoryView(PaintedWidget):
    """Threads as workers, callback groups as areas with seats, queues as belts, at the cursor's time.

    Set ``timeline`` again (it may be the same one) when it has grown. ``glance`` is how many nanoseconds of
    the run a worker is shown walking to an area or back: a moment on the screen times the run's speed.
    """

    BORDER_TITLE = "3 Factory"

    timeline: reactive[Timeline] = painted(Timeline, always_update=True)
    now: reactive[Nanoseconds] = painted(0)
    glance: reactive[Nanoseconds] = painted(GLANCE)
    charset: reactive[Charset] = painted(Charset.BRAILLE)

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the factory."""
        painter = FactoryPainter(self.charset)
        return painter.paint(self.timeline, self.now, size.width, size.height, self.glance)

    def show(self, timeline: Timeline, now: Nanoseconds, speed: float) -> None:
        """Show a moment of a run that goes at ``speed`` times real time."""
        self.now, self.timeline = now, timeline
        self.glance = round(GLANCE * speed)
