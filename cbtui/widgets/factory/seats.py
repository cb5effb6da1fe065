"""Draws the seats of an area: the worker with its callback and duration, arriving and leaving."""

from collections.abc import Callable, Sequence
from functools import partial

from cbtui.looks.theme import GLYPHS, Ink, Role
from cbtui.text.callback_names import short_name
from cbtui.widgets.factory.canvas import FAINT, PLAIN, STRONG, WARN, Canvas
from cbtui.widgets.factory.plan import AreaPlacement, FactoryColumns
from cbtui.widgets.factory.scene import STEPS, FactoryScene, FactoryWorker, WorkerState
from cbtui.widgets.factory.texts import (
    blocked_texts,
    crowd_texts,
    finished_texts,
    first_fitting,
    suspended_texts,
)
from sim.quantities.durations import duration
from sim.trace.model import EntityInfo, Nanoseconds

_FREE_SEATS = 4
"""Free seats that an open area shows; it always has room for more."""
_ABREAST = 4
"""Columns of a seat that has others beside it."""


class SeatPainter:
    """Draws the seats of one area, from the column ``start`` on, in one row each, or two if they fit."""

    tall = 1
    """The least rows of a seat."""

    def __init__(
        self, canvas: Canvas, scene: FactoryScene, place: AreaPlacement, columns: FactoryColumns, start: int
    ) -> None:
        self._canvas = canvas
        self._scene = scene
        self._place = place
        self._columns = columns
        self._start = start
        self._end = columns.right_wall
        area = place.area
        self._line_ink = Ink(Role.LINE, area.number)
        self._chip_ink = Ink(Role.LABEL, area.number)
        self._bar_ink = Ink(Role.BAR, area.number)
        self._blocked = GLYPHS[canvas.charset].blocked
        self._marks = canvas.glyphs.open_seat if area.is_open else canvas.glyphs.seat

    def draw(self) -> None:
        """Draw as many seats as there are rows; a walled area has its one seat in the middle."""
        area = self._place.area
        seats: list[Callable[[int, int], None]] = []
        seats += [partial(self._worker, worker) for worker in area.visitors if worker.inside]
        seats += [partial(self._kept, entity) for entity in area.kept]
        awaits = {entity.id for entity in area.kept}
        leaving = [
            worker
            for worker in area.visitors
            if not worker.inside and worker.span and worker.span.entity not in awaits
        ]
        if area.is_open:
            seats += [partial(self._left, worker) for worker in leaving]
            glyphs = self._canvas.glyphs
            inside = [worker for worker in area.visitors if worker.inside]
            faces = [self._blocked if worker.blocked else glyphs.busy for worker in inside]
            faces += [glyphs.away] * len(area.kept) + [" "] * len(leaving)
            self._open(seats, faces)
            return
        if not seats and leaving:
            seats = [partial(self._left, max(leaving, key=_end_of))]
        self._stacked(seats or [self._free])

    def _stacked(self, seats: Sequence[Callable[[int, int], None]]) -> None:
        """Draw seats below each other, in the middle of the area."""
        room = self._place.rows
        each = max(self.tall, min(self.tall + 1, room // len(seats), 3))
        line = self._place.first + max(0, room - each * len(seats)) // 2
        for seat in seats[: max(1, room // each)]:
            seat(line, each)
            line += each

    def _open(self, seats: Sequence[Callable[[int, int], None]], faces: Sequence[str]) -> None:
        """Draw seats below each other from the top, then free ones or those without a row side by side."""
        room = self._place.rows
        each = max(self.tall, min(self.tall + 1, (room - self.tall) // max(1, len(seats)), 3))
        shown = seats if len(seats) * each <= room else seats[: max(0, room - 1) // each]
        line = self._place.first
        for seat in shown:
            seat(line, each)
            line += each
        left = self._place.first + room - line
        if len(shown) < len(seats):
            self._crowd(faces[len(shown) :], line)
        elif left >= self.tall:
            self._free_seats(line)

    def _crowd(self, faces: Sequence[str], line: int) -> None:
        """Draw seats side by side, with no more than who sits there; count those that do not fit."""
        left, right = self._marks
        room = (self._end - self._start - len("+99 more")) // _ABREAST
        seats = "".join(f"{left}{face}{right} " for face in faces[:room])
        at = self._canvas.write(self._start, line, seats, self._line_ink, len(seats))
        more = [f"+{len(faces) - room} more"] if len(faces) > room else []
        texts = more or crowd_texts(faces.count(self._canvas.glyphs.busy), faces.count(self._blocked))
        self._canvas.write(at, line, first_fitting(texts, self._end - at), PLAIN, self._end - at)

    # one seat

    def _worker(self, worker: FactoryWorker, line: int, rows: int) -> None:
        """Draw a worker in its seat, or a taken seat and the worker on its way."""
        trouble = blocked_texts(worker, self._scene)
        took = self._took(worker)
        if worker.stay is WorkerState.COMES:
            self._walker(worker, line)
        if rows > 1:
            tails: Sequence[str] = (took,)
        elif trouble:
            tails = blocked_texts(worker, self._scene, is_brief=True)
        else:
            tails = (f"{took}  {worker.name}", took)
        at = self._chip(worker, line, tails[-1])
        room = self._end - at - 1
        tail = first_fitting(tails, room)
        self._canvas.write(at + 1, line, tail, WARN if trouble and rows == 1 else STRONG, room)
        if rows > 1:
            self._name(worker, trouble, self._start + 3, line + 1)

    def _chip(self, worker: FactoryWorker, line: int, tail: str) -> int:
        """Draw the seat with its worker and callback, if the text fits beside; return the column after it."""
        left, right = self._marks
        face = " " if worker.stay is WorkerState.COMES else self._canvas.glyphs.busy
        room = self._end - self._start - 4 - len(tail) - 1
        callback = self._callback(worker)
        name = first_fitting((callback, short_name(callback)), room) or short_name(callback)[: max(0, room)]
        self._canvas.put(self._start, line, left, self._bar_ink)
        inside = f"{face} {name}" if name else face
        at = self._canvas.write(self._start + 1, line, inside, self._chip_ink, len(inside))
        self._canvas.put(at, line, right, self._bar_ink)
        return at + 1

    def _left(self, worker: FactoryWorker, line: int, rows: int) -> None:
        """Draw a free seat, and the worker who has just left it, with the finished callback."""
        self._seat(self._start, line)
        self._walker(worker, line)
        room = self._end - self._start - 5
        texts = finished_texts(worker, self._callback(worker), self._scene.timeline)
        self._canvas.write(self._start + 4, line, first_fitting(texts, room) or texts[-1], FAINT, room)

    def _free(self, line: int, rows: int) -> None:
        self._seat(self._start, line)
        self._canvas.write(self._start + 4, line, "free", FAINT, self._end - self._start - 5)

    def _kept(self, entity: EntityInfo, line: int, rows: int) -> None:
        """Draw a seat that is held by a call on no thread."""
        self._seat(self._start, line)
        self._canvas.put(self._start + 1, line, self._canvas.glyphs.away, self._line_ink)
        room = self._end - self._start - 5
        texts = suspended_texts(entity, is_open=self._place.area.is_open)
        self._canvas.write(self._start + 4, line, first_fitting(texts, room) or texts[-1], PLAIN, room)

    def _free_seats(self, line: int) -> None:
        for place in range(min(_FREE_SEATS, (self._end - self._start) // _ABREAST)):
            self._seat(self._start + _ABREAST * place, line)

    def _seat(self, at: int, line: int) -> None:
        left, right = self._marks
        self._canvas.put(at, line, left, self._line_ink)
        self._canvas.put(at + 2, line, right, self._line_ink)

    # parts of a seat

    def _walker(self, worker: FactoryWorker, line: int) -> None:
        """Draw a worker between the area and the yard."""
        glyphs = self._canvas.glyphs
        comes = worker.stay is WorkerState.COMES
        sign = glyphs.comes + glyphs.busy if comes else glyphs.idle + glyphs.leaves
        at = self._aisle_place(worker, len(sign))
        for place, glyph in enumerate(sign):
            self._canvas.put(at + place, line, glyph, STRONG)

    def _aisle_place(self, worker: FactoryWorker, width: int) -> int:
        """Return the column of a worker of some width on its way."""
        way = max(0, self._columns.aisle - width)
        step = STEPS - 1 - worker.step if worker.stay is WorkerState.COMES else worker.step
        return self._columns.aisle_at + way * step // (STEPS - 1)

    def _name(self, worker: FactoryWorker, trouble: Sequence[str], at: int, line: int) -> None:
        room = self._end - at
        texts = [way for text in trouble for way in (f"{worker.name}, {text}", text)] or [worker.name]
        text = first_fitting(texts, room) or texts[-1]
        self._canvas.write(at, line, text, WARN if trouble else FAINT, room)

    def _took(self, worker: FactoryWorker) -> str:
        if worker.begins or worker.span is None:
            return "starts"
        return duration(max(0, self._scene.now - worker.span.start))

    def _callback(self, worker: FactoryWorker) -> str:
        entity = self._scene.timeline.entities.get(worker.span.entity) if worker.span else None
        return "" if entity is None else entity.spoken_name


def _end_of(worker: FactoryWorker) -> tuple[Nanoseconds, int]:
    """When a call ended, and its place among those that ended then."""
    span = worker.span
    return (0, 0) if span is None or span.end is None else (span.end, span.number)
