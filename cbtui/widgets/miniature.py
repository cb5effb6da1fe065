"""A run's lanes as a small picture, with a cursor that passes through them once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING

from textual.geometry import Size
from textual.reactive import reactive
from textual.timer import Timer

from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.text.cells import fit, lines_of_text
from cbtui.widgets.painted_widget import PaintedWidget, painted

if TYPE_CHECKING:
    from cbtui.widgets.lanes.painter import LanePainter
    from sim.trace.timeline import Timeline

FRAMES_A_SECOND = 5
SPEED = 2
"""Seconds of the run per real second."""
_LEAST_SCENE = 10
"""The least rows in which a robot's map can be recognised."""
_LEAST_CODE = 12
"""The least rows in which lines of code tell something."""
_STATUSES = (25, 16, 10, 0)
"""The widths of the status columns in the lane painter's layouts."""


@dataclass(frozen=True)
class PreviewPicture:
    """A finished run and its painter.

    ``scene`` paints its robot or figures at a moment, in a width and a height.
    """

    timeline: "Timeline"
    painter: "LanePainter"
    scene: Callable[[int, int, int], Sequence[Sequence[TextRun]]] | None = None


class Miniature(PaintedWidget):
    """Draws ``subject``, faintly after ``now`` (nanoseconds), or shows a sentence."""

    subject: reactive[PreviewPicture | None] = painted(None)
    now: reactive[int] = painted(0)
    sentence: reactive[str] = painted("")
    """The text without a picture."""
    code: reactive[str] = painted("")
    """The lines of code that are shown below the sentence, where there is room."""

    _began = 0.0
    _sweep: Timer | None = None

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the lanes, or the sentence."""
        if self.subject is None or not size.width:
            return sentence_rows(self.sentence, size, self.code)
        return miniature(self.subject, self.now, size)

    def watch_subject(self, subject: PreviewPicture | None) -> None:
        """Start the cursor of another run; without animations it stands at the end."""
        if self._sweep is not None:
            self._sweep.stop()
            self._sweep = None
        if subject is not None and self.app.animation_level == "none":
            self.now = subject.timeline.end
        elif subject is not None:
            self.now = 0
            self._began = monotonic()
            self._sweep = self.set_interval(1 / FRAMES_A_SECOND, self._go_on)

    def _go_on(self) -> None:
        """Move the cursor; it stops at the end, so as not to distract."""
        if self.subject is None or self._sweep is None:
            return
        end = self.subject.timeline.end
        self.now = min(end, round((monotonic() - self._began) * SPEED * 1e9))
        if self.now == end:
            self._sweep.stop()
            self._sweep = None


def miniature(subject: PreviewPicture, now: int, size: Size) -> list[Sequence[TextRun]]:
    """Paint a whole run in a size, without the status column; below it the scene, where there is room."""
    from cbtui.widgets.lanes import wanted_rows
    from cbtui.widgets.lanes.picture import layout_for  # whoever has a subject has imported it
    from sim.trace.model import Window

    layouts = ((beside, layout_for(max(20, size.width + beside))) for beside in _STATUSES)
    beside = next(beside for beside, layout in layouts if layout.statuses == beside)
    window = Window(0, subject.timeline.end)
    wanted = wanted_rows(subject.timeline, subject.painter.service, size.width + beside, window)
    room = size.height - wanted - 1
    below = subject.scene(now, size.width, room) if subject.scene and room >= _LEAST_SCENE else ()
    height = wanted if below else size.height
    picture = subject.painter.paint(subject.timeline, window, now, size.width + beside, height)
    rows: list[Sequence[TextRun]] = [row[:-1] if picture.layout.statuses else row for row in picture.rows]
    return [*rows, [TextRun(" " * size.width, Ink(Role.TEXT))], *below] if below else rows


def sentence_rows(sentence: str, size: Size, code: str = "") -> list[Sequence[TextRun]]:
    """Paint a wrapped sentence, and below it the first lines of code that fit; ``size`` may be empty."""
    if not size.width:
        return []
    lines = [(line, Ink(Role.FAINT)) for line in lines_of_text(sentence, size.width)[: size.height]]
    room = size.height - len(lines) - 1
    if code and room >= _LEAST_CODE:
        lines += [("", Ink(Role.TEXT)), *((line, Ink(Role.TEXT)) for line in code.splitlines()[:room])]
    return [[TextRun(fit(line, size.width, Charset.BRAILLE), ink)] for line, ink in lines]
