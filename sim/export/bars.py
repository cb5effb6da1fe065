"""The rows of a drawing of lanes and the bars on each, reduced to what is visible."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from sim.trace.model import EntityInfo, GroupInfo, Nanoseconds, Span, ThreadInfo, Wait, Window
from sim.trace.timeline import Timeline

_VISIBLE = 0.4
"""Pixels by which a bar must go beyond the one before to be drawn."""
_NARROWEST = 0.8


@dataclass(frozen=True, slots=True)
class PixelScale:
    """Maps the times of a window to pixels from ``left`` to ``right``."""

    window: Window
    left: float
    right: float

    def x(self, t: Nanoseconds) -> float:
        """The pixel of a time, clamped to the edges."""
        share = (t - self.window.start) / max(1, self.window.length)
        return self.left + min(1.0, max(0.0, share)) * (self.right - self.left)


IntervalT = TypeVar("IntervalT", Span, Wait)


@dataclass(frozen=True, slots=True)
class Bar(Generic[IntervalT]):
    """A bar from ``left`` to ``right``, in pixels; ``level`` is its nesting depth."""

    left: float
    right: float
    level: int
    interval: IntervalT


def rows(timeline: Timeline, window: Window) -> Iterator[ThreadInfo | GroupInfo | EntityInfo]:
    """All threads, then each group with its entities that have a callback, a call or a wait."""
    yield from timeline.threads.values()
    for group in timeline.groups.values():
        yield group
        for entity in timeline.group_members(group.id):
            shows = timeline.spans_of(entity.id, window) or timeline.waits_of(entity.id, window)
            if entity.callback or shows:
                yield entity


def bars(intervals: Iterable[IntervalT], scale: PixelScale, end: Nanoseconds) -> Iterator[Bar[IntervalT]]:
    """The bars of intervals in order of start, at most a few for each pixel and level.

    Open intervals end at ``end``.
    """
    running: list[Nanoseconds | None] = []
    drawn: list[float] = []
    for interval in intervals:
        until = interval.end_at(end)
        level = _free_level(running, interval.start)
        running[level] = until
        if level == len(drawn):
            drawn.append(scale.left - 1)
        left, right = scale.x(interval.start), scale.x(until)
        if right < drawn[level] + _VISIBLE:
            continue
        left = min(max(left, drawn[level]), scale.right - _NARROWEST)
        right = max(right, left + _NARROWEST)
        drawn[level] = right
        yield Bar(left, right, level, interval)


def losses(
    timeline: Timeline, entity: EntityInfo, scale: PixelScale, step: float
) -> Iterator[tuple[float, int]]:
    """Position and number of an entity's lost messages, summed over ``step`` pixels."""
    window = scale.window
    buckets = max(1, int((scale.right - scale.left) / step))
    for number in range(buckets):
        start = window.start + window.length * number // buckets
        end = window.start + window.length * (number + 1) // buckets
        lost = timeline.drops_of(entity.id, Window(start, end))
        if lost:
            yield scale.x((start + end) // 2), lost


def ticks(window: Window, most: int) -> Sequence[Nanoseconds]:
    """At most ``most`` round times in the window, in steps of 1, 2 or 5 times a power of ten."""
    step = 1
    while True:
        for factor in (1, 2, 5):
            if window.length <= step * factor * most:
                first = -(-window.start // (step * factor))
                return [n * step * factor for n in range(first, window.end // (step * factor) + 1)]
        step *= 10


def _free_level(running: list[Nanoseconds | None], start: Nanoseconds) -> int:
    """Return the first level whose interval has ended at ``start``."""
    for level, until in enumerate(running):
        if until is None or until <= start:
            return level
    running.append(None)
    return len(running) - 1
