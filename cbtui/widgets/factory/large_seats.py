"""Draws seats and workers three rows high, for a picture that a whole class can see."""

from cbtui.looks.theme import Ink
from cbtui.text.callback_names import short_name
from cbtui.widgets.factory.canvas import FAINT, PLAIN, STRONG, Canvas
from cbtui.widgets.factory.scene import FactoryWorker, WorkerState
from cbtui.widgets.factory.seats import SeatPainter
from cbtui.widgets.factory.texts import blocked_texts, finished_texts, first_fitting, suspended_texts
from sim.trace.model import EntityInfo

_CHAIR = 7
_WORDS_AT = _CHAIR + 3


def draw_figure(canvas: Canvas, at: int, line: int, head: str, legs: str, ink: Ink) -> None:
    """Draw a worker of three columns and rows; ``ink`` is that of its body."""
    canvas.put(at + 1, line, head, STRONG)
    canvas.write(at, line + 1, canvas.glyphs.figure.body, ink, 3)
    canvas.write(at, line + 2, legs, ink, 3)


class LargeSeatPainter(SeatPainter):
    """Draws armchairs in walled areas and stools in open ones."""

    tall = 3

    def _worker(self, worker: FactoryWorker, line: int, rows: int) -> None:
        trouble = blocked_texts(worker, self._scene)
        self._seat(self._start + 1, line)
        if worker.stay is WorkerState.COMES:
            self._walker(worker, line)
        else:
            canvas = self._canvas
            canvas.put(self._start + 4, line, canvas.glyphs.busy, STRONG)
            canvas.write(self._start + 3, line + 1, canvas.glyphs.figure.body, self._bar_ink, 3)
        at, room = self._start + _WORDS_AT, self._end - self._start - _WORDS_AT
        took = self._took(worker)
        callback = self._callback(worker)
        name = first_fitting((callback, short_name(callback)), room - len(took) - 4) or short_name(callback)
        after = self._canvas.write(at, line + 1, f" {name} ", self._chip_ink, room - len(took) - 3)
        self._canvas.write(after + 1, line + 1, took, STRONG, self._end - after - 1)
        self._name(worker, trouble, at + 1, line + 2)

    def _left(self, worker: FactoryWorker, line: int, rows: int) -> None:
        self._seat(self._start + 1, line)
        self._walker(worker, line)
        self._words(finished_texts(worker, self._callback(worker), self._scene.timeline), line, FAINT)

    def _free(self, line: int, rows: int) -> None:
        self._seat(self._start + 1, line)
        self._words(("free",), line, FAINT)

    def _kept(self, entity: EntityInfo, line: int, rows: int) -> None:
        self._seat(self._start + 1, line)
        self._words(suspended_texts(entity, is_open=self._place.area.is_open), line, PLAIN)

    def _free_seats(self, line: int) -> None:
        for place in range(min(4, (self._end - self._start) // (_CHAIR + 1))):
            self._seat(self._start + 1 + (_CHAIR + 1) * place, line)

    def _words(self, texts: tuple[str, ...], line: int, ink: Ink) -> None:
        room = self._end - self._start - _WORDS_AT - 1
        text = first_fitting(texts, room) or texts[-1]
        self._canvas.write(self._start + _WORDS_AT + 1, line + 1, text, ink, room)

    def _seat(self, at: int, line: int) -> None:
        figure = self._canvas.glyphs.figure
        rows = figure.stool if self._place.area.is_open else figure.armchair
        for below, row in enumerate(rows, start=1):
            self._canvas.write(at, line + below, row, self._line_ink, _CHAIR)

    def _walker(self, worker: FactoryWorker, line: int) -> None:
        glyphs, comes = self._canvas.glyphs, worker.stay is WorkerState.COMES
        head = glyphs.busy if comes else glyphs.idle
        legs = glyphs.figure.comes if comes else glyphs.figure.leaves
        draw_figure(self._canvas, self._aisle_place(worker, 3), line, head, legs, self._bar_ink)
