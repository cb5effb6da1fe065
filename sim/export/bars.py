"""The rows of a picture of lanes and the bars on each, reduced to what is visible."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from sim.trace.model import Entity, Group, Nanoseconds, Span, Thread, Wait, Window
from sim.trace.timeline import Timeline

_SEEN = 0.4
"""Pixels by which a bar must go beyond the one before to be drawn."""
_NARROWEST = 0.8


@dataclass(frozen=True, slots=True)
class Scale:
    """Where a time of the window lies between ``left`` and ``right``, in pixels."""

    window: Window
    left: float
    right: float

    def x(self, t: Nanoseconds) -> float:
        """The place of a time, at the edge for one outside."""
        share = (t - self.window.start) / max(1, self.window.length)
        return self.left + min(1.0, max(0.0, share)) * (self.right - self.left)


IntervalT = TypeVar("IntervalT", Span, Wait)


@dataclass(frozen=True, slots=True)
class Piece(Generic[IntervalT]):
    """A bar: from ``left`` to ``right`` in pixels; ``level`` counts the intervals that it lies within."""

    left: float
    right: float
    level: int
    interval: IntervalT


def rows(timeline: Timeline, window: Window) -> Iterator[Thread | Group | Entity]:
    """All threads; then each group with those of its entities that have a callback or something to show."""
    yield from timeline.threads.values()
    for group in timeline.groups.values():
        yield group
        for entity in timeline.group_members(group.id):
            shows = timeline.spans_of(entity.id, window) or timeline.waits_of(entity.id, window)
            if entity.callback or shows:
                yield entity


def pieces(intervals: Iterable[IntervalT], scale: Scale, end: Nanoseconds) -> Iterator[Piece[IntervalT]]:
    """The bars of intervals in order of start: no more than a few for each pixel and level.

    ``end`` is where those end that still last.
    """
    running: list[Nanoseconds | None] = []
    drawn: list[float] = []
    for interval in intervals:
        until = end if interval.end is None else interval.end
        level = _free_level(running, interval.start)
        running[level] = until
        if level == len(drawn):
            drawn.append(scale.left - 1)
        left, right = scale.x(interval.start), scale.x(until)
        if right < drawn[level] + _SEEN:
            continue
        left = min(max(left, drawn[level]), scale.right - _NARROWEST)
        right = max(right, left + _NARROWEST)
        drawn[level] = right
        yield Piece(left, right, level, interval)


def losses(timeline: Timeline, entity: Entity, scale: Scale, step: float) -> Iterator[tuple[float, int]]:
    """Where an entity's queue lost messages, and how many: one for each ``step`` pixels."""
    window = scale.window
    buckets = max(1, int((scale.right - scale.left) / step))
    for number in range(buckets):
        start = window.start + window.length * number // buckets
        end = window.start + window.length * (number + 1) // buckets
        lost = timeline.drops_of(entity.id, Window(start, end))
        if lost:
            yield scale.x((start + end) // 2), lost


def ticks(window: Window, most: int) -> Sequence[Nanoseconds]:
    """Round times in the window, at most so many of them, in steps of 1, 2 or 5 times a power of ten."""
    step = 1
    while True:
        for factor in (1, 2, 5):
            if window.length <= step * factor * most:
                first = -(-window.start // (step * factor))
                return [n * step * factor for n in range(first, window.end // (step * factor) + 1)]
        step *= 10


def _free_level(running: list[Nanoseconds | None], start: Nanoseconds) -> int:
    """The first level whose interval is over at ``start``."""
    for level, until in enumerate(running):
        if until is None or until <= start:
            return level
    running.append(None)
    return len(running) - 1
