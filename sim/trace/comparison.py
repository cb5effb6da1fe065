"""Two runs side by side: the figures of the same window of both, callback by callback."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TypeAlias

from sim.trace.model import Entity, Nanoseconds, Wait, Window
from sim.trace.statistics import CallbackStatistics, statistics_of, threads_at_once
from sim.trace.summary import RobotFigures, robot_in
from sim.trace.timeline import Timeline
from sim.trace.words import why_waiting

Key: TypeAlias = tuple[str, str, str, str, int]
"""What a callback is in any run: node, kind, callback, topic or service, and its number among equals."""


@dataclass(frozen=True, slots=True)
class WaitFigures:
    """How a ready callback was kept waiting in a window; ``why`` is what kept it most of that time."""

    longest: Nanoseconds
    total: Nanoseconds
    why: str


@dataclass(frozen=True, slots=True)
class Side:
    """What one of the runs says of a callback; ``waits`` None: it ran as soon as it was ready."""

    figures: CallbackStatistics
    waits: WaitFigures | None


@dataclass(frozen=True, slots=True)
class Pair:
    """A callback in both runs; None where a run has no such callback or nothing became of it."""

    name: str
    first: Side | None
    second: Side | None


@dataclass(frozen=True, slots=True)
class RunFigures:
    """A run in the window: threads that ran callbacks, the most at one moment, and what the robot did."""

    threads_used: int
    threads_at_once: int
    robot: RobotFigures | None


@dataclass(frozen=True, slots=True)
class Comparison:
    """The same window of two runs. Callbacks are in the order of appearance, the first run's first."""

    window: Window
    first: RunFigures
    second: RunFigures
    callbacks: tuple[Pair, ...]


def compare(first: Timeline, second: Timeline, window: Window) -> Comparison:
    """Compare a window of two runs; callbacks match by node, kind, function and topic or service."""
    sides = _sides(first, window), _sides(second, window)
    keys = list(dict.fromkeys([*sides[0], *sides[1]]))
    short = Counter(_short_name(key) for key in keys)
    return Comparison(
        window,
        _run_figures(first, window),
        _run_figures(second, window),
        tuple(
            Pair(
                _short_name(key) if short[_short_name(key)] == 1 else _long_name(key),
                sides[0].get(key),
                sides[1].get(key),
            )
            for key in keys
        ),
    )


def _short_name(key: Key) -> str:
    _, kind, callback, name, _ = key
    return callback or name or kind


def _long_name(key: Key) -> str:
    node, _, _, name, number = key
    place = " ".join(part for part in (node, name) if part)
    return f"{_short_name(key)} ({place}{f' #{number}' if number > 1 else ''})"


def _sides(timeline: Timeline, window: Window) -> dict[Key, Side]:
    equals: Counter[tuple[str, str, str, str]] = Counter()
    sides: dict[Key, Side] = {}
    for entity in timeline.entities.values():
        alike = _description(entity, timeline)
        equals[alike] += 1
        figures = statistics_of(timeline, entity.id, window)
        waits = _wait_figures(timeline.waits_of(entity.id, window), timeline, window)
        if figures.calls or figures.drops or waits:
            sides[*alike, equals[alike]] = Side(figures, waits)
    return sides


def _description(entity: Entity, timeline: Timeline) -> tuple[str, str, str, str]:
    return timeline.nodes.get(entity.node, ""), entity.kind.value, entity.callback, entity.name


def _wait_figures(waits: Sequence[Wait], timeline: Timeline, window: Window) -> WaitFigures | None:
    """Lengths are of what lies in the window; the waits of one series share the time since when they are."""
    shares: defaultdict[str, int] = defaultdict(int)
    longest = 0
    for _, series in groupby(waits, key=lambda wait: wait.since):
        length = 0
        for wait, part in _parts(series, timeline, window):
            shares[why_waiting(wait, timeline)] += part
            length += part
        longest = max(longest, length)
    if not longest:
        return None
    return WaitFigures(longest, sum(shares.values()), max(shares, key=shares.__getitem__))


def _parts(series: Iterator[Wait], timeline: Timeline, window: Window) -> Iterator[tuple[Wait, Nanoseconds]]:
    for wait in series:
        end = timeline.end if wait.end is None else wait.end
        yield wait, max(0, min(end, window.end) - max(wait.start, window.start))


def _run_figures(timeline: Timeline, window: Window) -> RunFigures:
    used = sum(bool(timeline.spans_on(thread, window)) for thread in timeline.threads)
    robot = robot_in(timeline, window)
    before = timeline.robot(window.start)
    if robot is not None and before is not None:
        robot = replace(robot, travelled=robot.travelled - before.travelled)
    return RunFigures(used, threads_at_once(timeline, window), robot)
