"""The widget of the factory: draws what its painter paints."""

from collections.abc import Sequence

from textual.geometry import Size
from textual.reactive import reactive, var

from cbtui.looks.theme import Charset, TextRun
from cbtui.text.cells import fit, lines_of_text
from cbtui.widgets.factory.canvas import WARN
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
    ring: reactive[tuple[str, ...]] = painted(())
    """Who waits for whom in the deadlock of the moment: ``tick``, ``/add``, ``group A``, ``tick``."""
    note: var[str] = var("")
    """The title's note on a deadlock."""
    charset: reactive[Charset] = painted(Charset.BRAILLE)

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the factory."""
        painter = FactoryPainter(self.charset)
        ring = f"deadlock: {' → '.join(self.ring)}" if self.ring else ""
        lines = lines_of_text(ring, max(1, size.width - 1), self.charset)[: size.height // 2]
        height = size.height - len(lines)
        rows = painter.paint(self.timeline, self.now, size.width, height, self.glance)
        return [*rows, *([TextRun(fit(f" {line}", size.width, self.charset), WARN)] for line in lines)]

    def show(self, timeline: Timeline, now: Nanoseconds, speed: float, ring: tuple[str, ...] = ()) -> None:
        """Show a moment of a run that goes at ``speed`` times real time, and the deadlock in it."""
        self.now, self.timeline = now, timeline
        self.ring, self.note = ring, "deadlock" if ring else ""
        self.glance = round(GLANCE * speed)
