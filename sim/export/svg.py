"""Draws a window of a run as lanes, for paper: threads, groups with their callbacks, and why they wait."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

from sim.export import svg_elements as draw
from sim.export.bars import Bar, PixelScale, bars, losses, rows, ticks
from sim.export.svg_elements import Box
from sim.export.texts import seconds, xml
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import name_of, why_waiting
from sim.trace.events import GroupKind, Reason
from sim.trace.figures.chains import ChainStep
from sim.trace.model import AxisMarkKind, EntityInfo, GroupInfo, Nanoseconds, Span, ThreadInfo, Wait, Window
from sim.trace.timeline import Timeline

LABELS = 210.0
"""Pixels for the names at the left."""
MARGIN = 14.0
NARROWEST = 480
WIDEST = 20_000
_ROW_HEIGHT = 22.0
_GAP = 3.0
_TICK_EVERY = 80.0
_LOSS_EVERY = 6.0
_LEVELS = 4


def svg(timeline: Timeline, window: Window, width: int = 1100, path: Sequence[ChainStep] = ()) -> str:
    """Return the picture as the text of an SVG file, ``width`` pixels wide and as high as its rows need.

    The steps of ``path`` are framed.

    Raises:
        ValueError: the window has no length, or the picture would be too narrow or too wide.
    """
    if window.length <= 0:
        raise ValueError("the picture's end must come after its start")
    if not NARROWEST <= width <= WIDEST:
        raise ValueError(f"a picture is {NARROWEST} to {WIDEST} pixels wide")
    return "\n".join(_Picture(timeline, window, width, path).lines()) + "\n"


class _Picture:
    def __init__(self, timeline: Timeline, window: Window, width: int, path: Sequence[ChainStep]) -> None:
        self._path = path
        self._timeline = timeline
        self._window = window
        self._width = width
        self._scale = PixelScale(window, LABELS + MARGIN, width - MARGIN)
        self._numbers = {group: number for number, group in enumerate(timeline.groups)}

    def lines(self) -> Iterator[str]:
        """The lines of the file."""
        body: list[str] = []
        y = MARGIN + 16
        body += self._title(y)
        y += 18
        top = y
        for row in rows(self._timeline, self._window):
            y += _GAP if isinstance(row, EntityInfo) else 2.5 * _GAP
            body += self._row(row, y)
            y += _ROW_HEIGHT
        body += self._marks(top, y)
        axis, y = self._axis(top, y)
        legend, y = self._legend(y + 18)
        yield (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{self._width}" height="{y:.0f}" '
            f'viewBox="0 0 {self._width} {y:.0f}" font-family="{draw.FONT}" '
            f'font-size="{draw.FONT_SIZE}">'
        )
        yield f"<title>{xml(self._heading())}</title>"
        yield draw.definitions(len(self._numbers) + 1)
        yield f'<rect width="{self._width}" height="{y:.0f}" fill="#FFFFFF"/>'
        yield from axis
        yield from body
        yield from legend
        yield "</svg>"

    def _heading(self) -> str:
        started = self._timeline.started
        target = started.target if started else "run"
        kinds = ", ".join(executor.kind for executor in self._timeline.executors.values())
        at = f"{_short(self._window.start)} to {_short(self._window.end)} s"
        return f"{target}: {at}" + (f", {kinds}" if kinds else "")

    def _title(self, y: float) -> Iterator[str]:
        room = self._width - 2 * MARGIN
        yield draw.words(MARGIN, y, draw.shortened(self._heading(), room), weight="bold")

    # rows

    def _row(self, row: ThreadInfo | GroupInfo | EntityInfo, y: float) -> Iterator[str]:
        yield draw.ground(Box(self._scale.left, y, self._scale.right - self._scale.left, _ROW_HEIGHT))
        indent = 14.0 if isinstance(row, EntityInfo) else 0.0
        label = draw.shortened(self._label(row), LABELS - indent - 6)
        weight = "" if isinstance(row, EntityInfo) else "bold"
        yield draw.words(MARGIN + indent, y + _ROW_HEIGHT / 2 + 4, label, weight=weight)
        if isinstance(row, ThreadInfo):
            yield from self._thread(row, y)
        elif isinstance(row, GroupInfo):
            yield from self._group(row, y)
        else:
            yield from self._entity(row, y)

    def _label(self, row: ThreadInfo | GroupInfo | EntityInfo) -> str:
        if isinstance(row, ThreadInfo):
            return row.name
        if isinstance(row, GroupInfo):
            return f"{row.letter} {row.kind.value} {self._timeline.nodes.get(row.node, '')}"
        return row.spoken_name

    def _thread(self, thread: ThreadInfo, y: float) -> Iterator[str]:
        spans = self._timeline.spans_on(thread.id, self._window)
        for bar in self._bars(spans):
            inset = min(bar.level, _LEVELS) * _ROW_HEIGHT / 8
            box = Box(bar.left, y + inset, bar.right - bar.left, _ROW_HEIGHT - 2 * inset)
            yield from self._call(bar, box, self._names(bar))

    def _group(self, group: GroupInfo, y: float) -> Iterator[str]:
        found = list(self._bars(self._timeline.spans_in(group.id, self._window)))
        levels = 1 + min(_LEVELS - 1, max((bar.level for bar in found), default=0))
        verb = "held by" if group.kind is GroupKind.EXCLUSIVE else "runs"
        for bar in found:
            level = min(bar.level, levels - 1)
            part = _ROW_HEIGHT / levels
            box = Box(bar.left, y + level * part + part / 4, bar.right - bar.left, part / 2)
            name = name_of(bar.interval.entity, self._timeline)
            yield from self._call(bar, box, (f"{verb} {name}", name) if levels == 1 else ())

    def _entity(self, entity: EntityInfo, y: float) -> Iterator[str]:
        height = _ROW_HEIGHT
        waits = self._timeline.waits_of(entity.id, self._window)
        for wait in bars(waits, self._scale, self._timeline.end):
            yield from self._wait(wait.interval, Box(wait.left, y + 1, wait.right - wait.left, height - 2))
        for bar in self._bars(self._timeline.spans_of(entity.id, self._window)):
            box = Box(bar.left, y + height / 5, bar.right - bar.left, height * 3 / 5)
            took = self._took(bar.interval)
            yield from self._call(bar, box, (f"runs {took}", took))
        for step in self._path:
            if step.entity == entity.id and step.end > self._window.start and step.start < self._window.end:
                x = self._scale.x(max(step.start, self._window.start))
                end = self._scale.x(min(step.end, self._window.end))
                yield draw.outline(Box(x, y, end - x, height), f"{duration(step.length)}: {step.words}")
        for x, lost in losses(self._timeline, entity, self._scale, _LOSS_EVERY):
            yield (
                f'<path d="M{x - 3:.2f},{y:.2f} h6 l-3,5 z" fill="{draw.WARN}">'
                f"<title>{lost} lost</title></path>"
            )

    def _bars(self, spans: Sequence[Span]) -> Iterator[Bar[Span]]:
        return bars(spans, self._scale, self._timeline.end)

    def _call(self, bar: Bar[Span], box: Box, texts: tuple[str, ...]) -> Iterator[str]:
        span = bar.interval
        yield draw.bar(box, self._number(span), self._about(span))
        text = draw.fitting(texts, box.width - 8)
        if text:
            yield draw.words(box.x + 4, box.y + box.height / 2 + 4, text)
        if span.error:
            middle = box.y + box.height / 2 + 4
            yield draw.words(box.x + box.width, middle, "✗", draw.WARN, anchor="middle", weight="bold")

    def _wait(self, wait: Wait, box: Box) -> Iterator[str]:
        why = why_waiting(wait, self._timeline)
        took = self._took(wait)
        yield draw.hatched(box, wait.reason, f"waits {took}: {why}")
        text = draw.fitting((f"waits {took}: {why}", f"{took}: {why}", why, took), box.width - 8)
        if text:
            yield draw.words(box.x + 4, box.y + box.height / 2 + 4, text)

    def _took(self, interval: Span | Wait) -> str:
        end = interval.end_at(self._timeline.end)
        return duration(end - interval.start)

    def _names(self, bar: Bar[Span]) -> tuple[str, ...]:
        entity = self._timeline.entities.get(bar.interval.entity)
        if entity is None:
            return ()
        group = self._timeline.groups.get(entity.group)
        letter = group.letter if group else ""
        return (f"{letter} {entity.spoken_name}".strip(), letter)

    def _about(self, span: Span) -> str:
        name = name_of(span.entity, self._timeline)
        error = f", raised {span.error}" if span.error else ""
        return f"{name}: {seconds(span.start)} s, {self._took(span)}{error}"

    def _number(self, span: Span) -> int:
        entity = self._timeline.entities.get(span.entity)
        unknown = len(self._numbers)
        return unknown if entity is None else self._numbers.get(entity.group, unknown)

    # around the rows

    def _marks(self, top: float, bottom: float) -> Iterator[str]:
        last = self._scale.left - _TICK_EVERY
        for mark in self._timeline.marks(self._window):
            x = self._scale.x(mark.at)
            if mark.kind is AxisMarkKind.ERROR or x < last + 2:
                continue
            yield draw.line(x, top, x, bottom, draw.FAINT, 0.7)
            if x - last > _TICK_EVERY:
                room = min(_TICK_EVERY * 3, self._scale.right - x)
                yield draw.words(x + 2, top + 4, draw.shortened(mark.text, room), draw.FAINT)
            last = x

    def _axis(self, top: float, bottom: float) -> tuple[list[str], float]:
        drawn = [draw.line(self._scale.left, bottom + 5, self._scale.right, bottom + 5, draw.FAINT)]
        found = ticks(self._window, max(2, int((self._scale.right - self._scale.left) / _TICK_EVERY)))
        places = _places([after - before for before, after in pairwise(found)])
        for t in found:
            x = self._scale.x(t)
            drawn.append(draw.line(x, top, x, bottom + 9))
            drawn.append(draw.words(x, bottom + 21, f"{t / 1e9:.{places}f}", draw.FAINT, "middle"))
        drawn.append(draw.words(LABELS, bottom + 21, "s", draw.FAINT, "end"))
        return drawn, bottom + 24

    def _legend(self, y: float) -> tuple[list[str], float]:
        entries: list[tuple[str, str]] = []
        for group, number in self._numbers.items():
            known = self._timeline.groups[group]
            entries.append((draw.bar(Box(0, 0, 18, 11), number, ""), f"{known.letter} {known.class_name}"))
        entries += [
            (draw.hatched(Box(0, 0, 18, 11), reason, ""), f"waits: {reason.value}") for reason in Reason
        ]
        loss = f'<path d="M6,3 h6 l-3,5 z" fill="{draw.WARN}"/>'
        entries.append((loss, "message lost"))
        entries.append((draw.words(9, 10, "✗", draw.WARN, "middle", "bold"), "raised an exception"))
        if self._path:
            entries.append((draw.outline(Box(0, 0, 18, 11), ""), "critical path of a chain"))
        return self._flowing(entries, y)

    def _flowing(self, entries: Sequence[tuple[str, str]], y: float) -> tuple[list[str], float]:
        """The entries one after another, as many in a line as fit."""
        drawn: list[str] = []
        x = MARGIN
        for sign, text in entries:
            room = 24 + len(text) * draw.CHARACTER + 16
            if x > MARGIN and x + room > self._width - MARGIN:
                x, y = MARGIN, y + 18
            drawn.append(f'<g transform="translate({x:.2f},{y:.2f})">{sign}{draw.words(24, 10, text)}</g>')
            x += room
        return drawn, y + 18 + MARGIN


def _short(t: Nanoseconds) -> str:
    return seconds(t).rstrip("0").rstrip(".")


def _places(steps: Sequence[Nanoseconds]) -> int:
    """Return the decimals of a second that distinguish ticks."""
    step = min(steps, default=SECOND)
    return next((places for places in range(9) if step % 10 ** (9 - places) == 0), 9)
