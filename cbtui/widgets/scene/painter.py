"""Paints a scene at a moment: each figure as far as its callback has moved it, and the callback's state."""

from collections.abc import Sequence
from itertools import product
from operator import attrgetter
from typing import NamedTuple

from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.text.cells import fit
from cbtui.widgets.dots import DotGrid
from cbtui.widgets.scene.figures import ACROSS, DOWN, FIGURES
from lessons.description import Actor
from sim.quantities.durations import duration
from sim.quantities.plural import counted
from sim.trace.descriptions import doing_of, why_waiting
from sim.trace.figures.waiting import wait_told, waited_so_far
from sim.trace.model import EntityInfo, Moment, Nanoseconds, Window
from sim.trace.timeline import Timeline

_COLUMNS, _ROWS = 10, 2
_GAP = 2
_BESIDE_LARGE = 60
"""The columns from which words stand beside a large figure."""
_STATE = 14
"""Columns of most states, with the space before them."""
_HALF_WAY: Nanoseconds = 300_000_000
"""Duration of a callback at which its figure has gone half of its way."""
_BACK: Nanoseconds = 500_000_000
"""Duration of a figure's way back."""
_LATELY: Nanoseconds = 1_000_000_000
_FAINT, _PLAIN, _STRONG, _WARN = Ink(Role.FAINT), Ink(Role.TEXT), Ink(Role.STRONG), Ink(Role.WARN)


class _State(NamedTuple):
    """A figure's progress from 0 to 1, its callback's state, and the reason."""

    progress: float
    words: str
    reason: str = ""
    is_trouble: bool = False


def paint_scene(
    actors: Sequence[Actor], timeline: Timeline, now: Nanoseconds, width: int, height: int, charset: Charset
) -> list[list[TextRun]]:
    """Return at most ``height`` rows of ``width`` columns.

    Where there is room the figures are twice as large, with the words beside or below them. In few columns
    the words stand one below the other. Without room for all figures, the last ones are words alone; without
    room for these, a number.
    """
    moment = timeline.moment(now)
    numbers = {group: place for place, group in enumerate(timeline.groups)}
    blank = [TextRun(" " * width, _PLAIN)]
    large = 2 * _ROWS if width >= _BESIDE_LARGE else 2 * _ROWS + 2
    is_large = height >= len(actors) * (large + 1) - 1
    scale, below = 2 if is_large else 1, is_large and width < _BESIDE_LARGE
    apart = height >= len(actors) * (_ROWS + 1)
    longest = max((len(actor.follows) for actor in actors), default=0)
    is_stacked = apart and not is_large and _COLUMNS + _GAP + longest + _STATE > width
    rows: list[list[TextRun]] = []
    shown = actors if len(actors) <= height else actors[: max(0, height - 1)]
    for place, actor in enumerate(shown):
        found = (each for each in timeline.entities.values() if actor.follows in (each.callback, each.name))
        entity = next(found, None)
        state = _State(0.0, "is not there yet") if entity is None else _state(entity, timeline, moment)
        ink = _FAINT if entity is None else Ink(Role.LINE, numbers.get(entity.group, 0))
        name, gap = TextRun(actor.follows, _STRONG), TextRun(" " * _GAP, _PLAIN)
        words = TextRun(f" {state.words}", _WARN if state.is_trouble else _PLAIN)
        reason = TextRun(state.reason, _WARN if state.is_trouble else _FAINT)
        if place < height - len(actors):
            lines = _figure(actor.figure, state.progress, ink, charset, scale)
            if below:
                lines += [[name, words], [reason]]
            elif is_stacked:
                lines[0] += [gap, name]
                lines[1] += [TextRun(" ", _PLAIN), words]
                lines += [[reason]]
            else:
                lines[scale - 1] += [gap, name, words]
                lines[scale] += [gap, reason]
        else:
            colon = reason._replace(text=": " if state.reason else "")
            lines = [[TextRun(" " * _COLUMNS, _PLAIN), gap, name, words, colon, reason]]
        rows += [_fitted(line, width, charset) for line in lines]
        rows += [blank] if apart and not is_stacked else []
    if len(shown) < len(actors):
        rows.append(_fitted([TextRun(f"+{len(actors) - len(shown)} more", _FAINT)], width, charset))
    return rows[:height]


def _figure(name: str, progress: float, ink: Ink, charset: Charset, scale: int) -> list[list[TextRun]]:
    """Return the rows of a figure that has gone a part of its way, ``scale`` times as large as usual."""
    figure, grid = FIGURES[name], DotGrid(_COLUMNS * scale, _ROWS * scale, charset)
    across, down = grid.across * _COLUMNS * scale / ACROSS, grid.down * _ROWS * scale / DOWN
    strokes = [(right / scale, under / scale) for right in range(scale) for under in range(scale)]
    parts = [((0, 0), figure.still, 1), *((by, lines, 2) for by, lines in figure.moving)]
    for (by_x, by_y), lines, layer in parts:
        x, y = round(by_x * progress), round(by_y * progress)
        for (left, top, end, bottom), (right, under) in product(lines, strokes):
            start = (left + x + right) * across, (top + y + under) * down
            grid.line(start, ((end + x + right) * across, (bottom + y + under) * down), layer)
    return [row.runs() for row in grid.rows((_PLAIN, _FAINT, ink), " .#")]


def _fitted(runs: Sequence[TextRun], width: int, charset: Charset) -> list[TextRun]:
    shown, room = list[TextRun](), width
    for text, ink in runs:
        shown.append(TextRun(fit(text, min(len(text), room), charset) if text and room else "", ink))
        room -= len(shown[-1].text)
    return [*shown, TextRun(" " * room, _PLAIN)]


def _state(entity: EntityInfo, timeline: Timeline, moment: Moment) -> _State:
    at = moment.at
    lost = len(timeline.losses_of(entity.id, Window(max(0, at - _LATELY), at + 1)))
    losses = f"lost {counted(lost, 'message')} in a second" if lost else ""
    calls = (span for span in moment.running.values() if span.entity == entity.id)
    running = min(calls, key=attrgetter("start"), default=None)  # of several the longest
    if running is not None:
        elapsed = at - running.start
        blocked = moment.blocked.get(running.thread)
        position = timeline.position_on(running.thread, at)
        if blocked is not None and blocked.entity == entity.id:
            doing = f"blocked in the call of {blocked.service}"
        else:
            doing = "" if position is None or position.entity != entity.id else doing_of(position)
        return _State(elapsed / (elapsed + _HALF_WAY), f"runs {duration(elapsed)}", doing, bool(blocked))
    wait = wait_told(entity.id, moment, timeline)
    if wait is not None:
        reasons = filter(None, (why_waiting(wait, timeline), losses))
        return _State(0.0, f"waits {waited_so_far(wait, moment, timeline)}", "; ".join(reasons), True)
    before = timeline.spans_of(entity.id, Window(max(0, at - _BACK), at + 1))
    if before:
        since = at - before[-1].end_at(at)
        return _State(1 - min(1.0, since / _BACK), "has just run", before[-1].error or losses)
    return _State(
        0.0, "rests" if timeline.calls_of(entity.id, Window(0, at + 1)) else "has not run yet", losses
    )
