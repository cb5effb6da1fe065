"""A comparison of two runs as rows of a table: both figures, the difference, and whether it is better."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple, TypeAlias, TypeVar

from sim.durations import duration
from sim.trace.figures.comparison import CallbackInRun, CallbackPair, Comparison, RunFigures
from sim.trace.figures.statistics import Distribution
from sim.trace.figures.summary import RobotFigures
from sim.trace.model import Window

RUNS = ("run A", "run B")
"""What the runs are called in a table: groups have single letters."""
DIFFERENCE = "B against A"
NOTHING = "-"


class Assessment(Enum):
    """Whether the second run is better than the first, worse, or merely different."""

    SAME = auto()
    BETTER = auto()
    WORSE = auto()
    OTHER = auto()


@dataclass(frozen=True, slots=True)
class ComparisonRow:
    """One figure of both runs, and the difference in words: ``-392 fewer``."""

    label: str
    figures: tuple[str, str]
    difference: str = ""
    assessment: Assessment = Assessment.OTHER


@dataclass(frozen=True, slots=True)
class Section:
    """The rows of one callback, or of the runs as a whole; ``notes`` are sentences below them."""

    title: str
    rows: tuple[ComparisonRow, ...]
    notes: tuple[str, ...] = ()


Figure: TypeAlias = float | None


class _Spread(NamedTuple):
    """The usual value and the highest one."""

    median: Figure
    most: float


class _Words(NamedTuple):
    """How figures of a kind are written, what a higher and a lower one is called, and what they mean."""

    write: Callable[[float], str]
    higher: str
    lower: str
    more_is_worse: bool = False


def _count(number: float) -> str:
    return f"{number:.0f}"


def _length(nanoseconds: float) -> str:
    return duration(round(nanoseconds))


def _metres(metres: float) -> str:
    return f"{metres:.2f} m"


def _radians(radians: float) -> str:
    return f"{radians:.1f} rad"


_COUNTS = _Words(_count, "more", "fewer")
_LOSSES = _COUNTS._replace(more_is_worse=True)
_WAITS = _Words(_length, "longer", "shorter", more_is_worse=True)
_AGES = _Words(_length, "older", "fresher", more_is_worse=True)
_LATENESS = _Words(_length, "later", "sooner", more_is_worse=True)
_DISTANCES = _Words(_metres, "farther", "less far")
_ANGLES = _Words(_radians, "more", "less")


def sections(comparison: Comparison) -> tuple[Section, ...]:
    """The whole comparison: callback by callback, then the threads and what the robot did."""
    return (
        *(_section(pair) for pair in comparison.callbacks),
        Section("whole program", tuple(_whole(comparison.first, comparison.second))),
    )


def extent(comparison: Comparison) -> str:
    """Which part of the runs is compared: ``0 to 12.4 s; run A goes on to 20 s``."""
    window = comparison.window
    parts = [stretch(window)]
    for name, run in zip(RUNS, (comparison.first, comparison.second), strict=True):
        if run.end > window.end:
            parts.append(f"{name} goes on to {_seconds(run.end)} s")
    return "; ".join(parts)


def stretch(window: Window) -> str:
    """A window in words: ``0 to 12.4 s``."""
    return f"{_seconds(window.start)} to {_seconds(window.end)} s"


def _seconds(nanoseconds: int) -> str:
    return f"{round(nanoseconds / 1e9, 3):g}" if nanoseconds < 100_000_000_000 else f"{nanoseconds / 1e9:.1f}"


def _whole(first: RunFigures, second: RunFigures) -> Iterator[ComparisonRow]:
    yield _row("threads used", first.threads_used, second.threads_used, _COUNTS)
    yield _row("at once", first.threads_at_once, second.threads_at_once, _COUNTS)
    if first.robot is None and second.robot is None:
        return
    for label, figure, words in _ROBOT_FIGURES:
        yield _row(label, _asked(figure, first.robot), _asked(figure, second.robot), words)
    yield _row("collisions", _collisions(first), _collisions(second), _LOSSES)
    yield _place(first.robot, second.robot)
    yield _heading(first.robot, second.robot)


def _collisions(run: RunFigures) -> Figure:
    return None if run.robot is None else run.collisions


_ROBOT_FIGURES: tuple[tuple[str, Callable[[RobotFigures], Figure], _Words], ...] = (
    ("robot travelled", lambda robot: robot.travelled, _DISTANCES),
    ("robot turned", lambda robot: robot.turned, _ANGLES),
    ("turns", lambda robot: robot.turns, _COUNTS),
)


def _place(first: RobotFigures | None, second: RobotFigures | None) -> ComparisonRow:
    figures = _of_both(lambda robot: f"{_places(robot.x)} {_places(robot.y)} m", first, second)
    label = "robot at x y"
    if first is None or second is None:
        return ComparisonRow(label, figures)
    if figures[0] == figures[1]:
        return ComparisonRow(label, figures, "same", Assessment.SAME)
    return ComparisonRow(
        label, figures, f"{_metres(math.hypot(first.x - second.x, first.y - second.y))} apart"
    )


def _places(metres: float) -> str:
    """Two places; what rounds to nothing has no minus."""
    return f"{round(metres, 2) + 0.0:.2f}"


def _heading(first: RobotFigures | None, second: RobotFigures | None) -> ComparisonRow:
    figures = _of_both(lambda robot: f"{_degrees(robot.yaw)}°", first, second)
    if first is None or second is None:
        return ComparisonRow("heading", figures)
    turned = _degrees(math.remainder(second.yaw - first.yaw, math.tau))
    if turned == 0:
        return ComparisonRow("heading", figures, "same", Assessment.SAME)
    return ComparisonRow("heading", figures, f"{turned:+}° {'left' if turned > 0 else 'right'}")


def _degrees(radians: float) -> int:
    return round(math.degrees(radians))


_Told = TypeVar("_Told")


def _of_both(write: Callable[[_Told], str], first: _Told | None, second: _Told | None) -> tuple[str, str]:
    return (
        NOTHING if first is None else write(first),
        NOTHING if second is None else write(second),
    )


def _section(pair: CallbackPair) -> Section:
    first, second = pair.first, pair.second
    title = pair.name
    if first is None or second is None:
        title += f": only in {RUNS[first is None]}"
    notes = (
        f"{name} waits: {side.waits.why}"
        for name, side in zip(RUNS, (first, second), strict=True)
        if side and side.waits
    )
    return Section(title, tuple(_rows(first, second)), tuple(notes))


def _rows(first: CallbackInRun | None, second: CallbackInRun | None) -> Iterator[ComparisonRow]:
    for label, figure, words in _FIGURES:
        one, other = _asked(figure, first), _asked(figure, second)
        if one is not None or other is not None:
            yield _row(label, one, other, words)
    for label, spread, words in _SPREADS:
        of_first, of_second = _asked(spread, first), _asked(spread, second)
        if of_first or of_second:
            yield _spread_row(label, of_first, of_second, words)


_Asked = TypeVar("_Asked")


def _asked(question: Callable[[_Asked], _Told | None], asked: _Asked | None) -> _Told | None:
    return None if asked is None else question(asked)


def _waited(side: CallbackInRun) -> _Spread | None:
    waits = side.figures.wait
    if waits is None and not side.longest_wait:
        return None
    return _Spread(None if waits is None else waits.median, side.longest_wait)


def _spread(values: Distribution | None) -> _Spread | None:
    return None if values is None else _Spread(values.median, values.most)


_FIGURES: tuple[tuple[str, Callable[[CallbackInRun], Figure], _Words], ...] = (
    ("calls", lambda side: side.figures.calls, _COUNTS),
    ("errors", lambda side: side.figures.errors or None, _LOSSES),
    ("drops", lambda side: side.figures.drops if side.figures.entity.depth else None, _LOSSES),
)
_SPREADS: tuple[tuple[str, Callable[[CallbackInRun], _Spread | None], _Words], ...] = (
    ("wait med/max", _waited, _WAITS),
    ("age med/max", lambda side: _spread(side.figures.age), _AGES),
    ("late med/max", lambda side: _spread(side.figures.late), _LATENESS),
)


def _row(label: str, first: Figure, second: Figure, words: _Words) -> ComparisonRow:
    figures = _of_both(words.write, first, second)
    if first is None or second is None:
        return ComparisonRow(label, figures)
    return ComparisonRow(label, figures, *_difference(first, second, words))


def _spread_row(label: str, first: _Spread | None, second: _Spread | None, words: _Words) -> ComparisonRow:
    """A row of two spreads; what differs is told of the highest, and of the usual if only that differs."""
    figures = _of_both(lambda spread: _spread_text(spread, words), first, second)
    if first is None or second is None:
        return ComparisonRow(label, figures)
    which = "max"
    text, assessment = _difference(first.most, second.most, words)
    if assessment is Assessment.SAME and first.median is not None and second.median is not None:
        which = "med"
        text, assessment = _difference(first.median, second.median, words)
    return ComparisonRow(
        label, figures, text if assessment is Assessment.SAME else f"{which} {text}", assessment
    )


def _spread_text(spread: _Spread, words: _Words) -> str:
    median = NOTHING if spread.median is None else words.write(spread.median)
    return f"{median} / {words.write(spread.most)}"


def _difference(first: float, second: float, words: _Words) -> tuple[str, Assessment]:
    """In words, as exactly as the figures themselves are written."""
    if words.write(first) == words.write(second):
        return "same", Assessment.SAME
    step = second - first
    sign, word = ("+", words.higher) if step > 0 else ("-", words.lower)
    assessment = Assessment.OTHER
    if words.more_is_worse:
        assessment = Assessment.WORSE if step > 0 else Assessment.BETTER
    return f"{sign}{words.write(abs(step))} {word}", assessment
