"""Draws the yard, in which every idle worker has its place."""

from collections.abc import Sequence

from cbtui.looks.theme import Ink
from cbtui.widgets.factory.canvas import FAINT, PLAIN, STRONG, Canvas
from cbtui.widgets.factory.large_seats import draw_figure
from cbtui.widgets.factory.scene import FactoryScene, FactoryWorker, WorkerState
from cbtui.widgets.factory.texts import activity_texts

_UNUSED = (WorkerState.NEVER, WorkerState.NOT_YET)


def draw_yard(canvas: Canvas, scene: FactoryScene, column: int, first: int, after: int) -> None:
    """Draw the workers below each other from ``column`` on, in the rows ``first`` to before ``after``."""
    room = max(0, after - first)
    fitting = len(scene.workers) if len(scene.workers) <= room else max(0, room - 1)
    busy_first = sorted(scene.workers, key=_at_home)
    shown = [worker for worker in scene.workers if worker in busy_first[:fitting]]
    width = canvas.width - column
    for line, worker in enumerate(shown, start=first):
        texts = activity_texts(worker, scene.timeline)
        text = next((each for each in texts if len(each) + len(worker.name) + 3 <= width), texts[-1])
        at = _person(canvas, worker, column, line, width - 2)
        canvas.write(at + 1, line, text, _ink(worker), column + width - at - 1)
    if len(shown) < len(scene.workers):
        hidden = busy_first[fitting:]
        canvas.write(column, after - 1, f"+{len(hidden)}: {_counted(hidden)}", FAINT, width)


def draw_bench(canvas: Canvas, scene: FactoryScene, line: int) -> None:
    """Draw the workers side by side in one row, with as much text as fits."""
    if not scene.workers:
        return
    words = [(*activity_texts(worker, scene.timeline), "") for worker in scene.workers]
    for brevity in range(4):
        slots = [
            len(worker.name) + 2 + (1 + len(texts[brevity]) if texts[brevity] else 0) + 2
            for worker, texts in zip(scene.workers, words, strict=True)
        ]
        if sum(slots) - 1 <= canvas.width:
            break
    else:
        _crowd(canvas, scene, line)
        return
    column = 1
    for worker, texts, slot in zip(scene.workers, words, slots, strict=True):
        at = _person(canvas, worker, column, line, slot)
        canvas.write(at + 1, line, texts[brevity], _ink(worker), slot)
        column += slot


def _crowd(canvas: Canvas, scene: FactoryScene, line: int) -> None:
    """Draw more workers than fit with their names: figures, and the number in each state."""
    glyphs = canvas.glyphs
    figures = "".join(glyphs.idle if _at_home(worker) else glyphs.away for worker in scene.workers)
    at = canvas.write(1, line, figures, STRONG, canvas.width // 2)
    text = _counted(scene.workers)
    canvas.write(at + 1, line, text, FAINT, canvas.width - at - 1)


def _counted(workers: Sequence[FactoryWorker]) -> str:
    busy = sum(worker.inside for worker in workers)
    unused = sum(worker.stay in _UNUSED for worker in workers)
    stopped = sum(worker.stay is WorkerState.STOPPED for worker in workers)
    idle = len(workers) - busy - unused - stopped
    parts = ((busy, "busy"), (idle, "idle"), (stopped, "stopped"), (unused, "unused"))
    return ", ".join(f"{number} {what}" for number, what in parts if number)


def _at_home(worker: FactoryWorker) -> bool:
    return worker.stay in (WorkerState.IDLE, *_UNUSED)


def _ink(worker: FactoryWorker) -> Ink:
    return PLAIN if worker.stay is WorkerState.IDLE else FAINT


def _person(canvas: Canvas, worker: FactoryWorker, column: int, line: int, room: int) -> int:
    """Draw a worker's place with its name; return the column after it."""
    home = _at_home(worker)
    canvas.put(column, line, canvas.glyphs.idle if home else canvas.glyphs.away, STRONG if home else FAINT)
    return canvas.write(column + 2, line, worker.name, PLAIN if home else FAINT, room)


def draw_large_yard(canvas: Canvas, scene: FactoryScene, column: int, first: int) -> None:
    """Draw every worker as a figure of three rows and a blank one below; all of them have room."""
    width = canvas.width - column
    for place, worker in enumerate(scene.workers):
        line = first + 4 * place
        home = _at_home(worker)
        if home:
            draw_figure(canvas, column, line, canvas.glyphs.idle, canvas.glyphs.figure.legs, PLAIN)
        else:
            canvas.put(column + 1, line + 1, canvas.glyphs.away, FAINT)
        canvas.write(column + 5, line + 1, worker.name, PLAIN if home else FAINT, width - 5)
        canvas.write(column + 5, line + 2, activity_texts(worker, scene.timeline)[0], _ink(worker), width - 5)
