"""A comparison of two runs as rows of a table: both figures, the difference, and whether it is better."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple, TypeAlias, TypeVar

from sim.trace.figures.comparison import CallbackInRun, CallbackPair, Comparison, RunFigures
from sim.trace.figures.comparison_wording import (
    AGES,
    ANGLES,
    CALLS,
    COUNTS,
    DISTANCES,
    ERRORS,
    FLAWS,
    LATENESS,
    LOSSES,
    RUNNING,
    WAITS,
    Wording,
    metres,
    stretch,
)
from sim.trace.figures.statistics import Distribution
from sim.trace.figures.summary import RobotFigures
from sim.trace.figures.waiting import WORTH_TELLING

RUNS = ("run A", "run B")
"""Names of the runs in a table: single letters are callback groups."""
DIFFERENCE = "B against A"
NOTHING = "-"
_SAME = "same"


class Assessment(Enum):
    """Whether the second run is better than the first, worse, or merely different."""

    SAME = auto()
    BETTER = auto()
    WORSE = auto()
    OTHER = auto()


@dataclass(frozen=True, slots=True)
class ComparisonRow:
    """One figure of both runs, and the difference in words: ``392 fewer``."""

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

    @property
    def is_even(self) -> bool:
        """Whether no row is better or worse in a run."""
        return {Assessment.BETTER, Assessment.WORSE}.isdisjoint(row.assessment for row in self.rows)


Figure: TypeAlias = float | None


class _Spread(NamedTuple):
    """The median and the maximum; ``lasts``: it is that of a wait which still goes on."""

    median: Figure
    most: float
    lasts: bool


def sections(comparison: Comparison) -> tuple[Section, ...]:
    """The whole comparison: first callbacks that do better or worse, then those that run far more often."""
    told = [(pair, _section(pair, is_real=comparison.is_real)) for pair in comparison.callbacks]
    told.sort(
        key=lambda each: (each[1].is_even, not (each[0].is_unlike and each[0].first and each[0].second))
    )
    whole = tuple(_whole(comparison.first, comparison.second))
    notes = () if whole else (f"no callback runs in either, {stretch(comparison.window)}",)
    return (*(section for _, section in told), Section("whole program", whole, notes))


def _whole(first: RunFigures, second: RunFigures) -> Iterator[ComparisonRow]:
    if first.threads_used or second.threads_used:
        yield _row("threads used", first.threads_used, second.threads_used, COUNTS)
        yield _row("at once", first.threads_at_once, second.threads_at_once, COUNTS)
    if all(_stands(run.robot) for run in (first, second) if run.robot is not None):
        return  # it has no part in either run
    for label, figure, wording in _ROBOT_FIGURES:
        yield _row(label, _apply(figure, first.robot), _apply(figure, second.robot), wording)
    yield _row("collisions", _collisions(first), _collisions(second), FLAWS)
    yield _place(first.robot, second.robot)
    yield _heading(first.robot, second.robot)


_MOVES = 0.005
"""The least metres or radians that are a movement."""


def _stands(robot: RobotFigures) -> bool:
    return not robot.turns and max(robot.travelled, robot.turned) < _MOVES


def _collisions(run: RunFigures) -> Figure:
    return None if run.robot is None else run.collisions


_ROBOT_FIGURES: tuple[tuple[str, Callable[[RobotFigures], Figure], Wording], ...] = (
    ("robot travelled", lambda robot: robot.travelled, DISTANCES),
    ("robot turned", lambda robot: robot.turned, ANGLES),
    ("turns", lambda robot: robot.turns, COUNTS),
)


def _place(first: RobotFigures | None, second: RobotFigures | None) -> ComparisonRow:
    figures = _format_both(lambda robot: f"{_places(robot.x)} {_places(robot.y)} m", first, second)
    label = "robot at x y"
    if first is None or second is None:
        return ComparisonRow(label, figures)
    if figures[0] == figures[1]:
        return ComparisonRow(label, figures, "same", Assessment.SAME)
    return ComparisonRow(
        label, figures, f"{metres(math.hypot(first.x - second.x, first.y - second.y))} apart"
    )


def _places(metres: float) -> str:
    """Two decimals; zero has no minus sign."""
    return f"{round(metres, 2) + 0.0:.2f}"


def _heading(first: RobotFigures | None, second: RobotFigures | None) -> ComparisonRow:
    figures = _format_both(lambda robot: f"{_degrees(robot.yaw)}°", first, second)
    if first is None or second is None:
        return ComparisonRow("heading", figures)
    turned = _degrees(math.remainder(second.yaw - first.yaw, math.tau))
    if turned == 0:
        return ComparisonRow("heading", figures, "same", Assessment.SAME)
    return ComparisonRow("heading", figures, f"{turned:+}° {'left' if turned > 0 else 'right'}")


def _degrees(radians: float) -> int:
    return round(math.degrees(radians))


ResultT = TypeVar("ResultT")


def _format_both(
    write: Callable[[ResultT], str], first: ResultT | None, second: ResultT | None
) -> tuple[str, str]:
    return (NOTHING if first is None else write(first), NOTHING if second is None else write(second))


def _section(pair: CallbackPair, *, is_real: bool) -> Section:
    first, second = pair.first, pair.second
    title = pair.name
    if first is None or second is None:
        title += f": only in {RUNS[first is None]}"
    notes = (
        f"{name} waits: {side.waits.why}"
        for name, side in zip(RUNS, (first, second), strict=True)
        if side and side.waits and side.longest_wait >= WORTH_TELLING
    )
    return Section(title, tuple(_rows(first, second, is_real=is_real)), tuple(notes))


def _rows(
    first: CallbackInRun | None, second: CallbackInRun | None, *, is_real: bool
) -> Iterator[ComparisonRow]:
    for label, figure, wording in _FIGURES:
        one, other = _apply(figure, first), _apply(figure, second)
        if (one is not None or other is not None) and (one or other or wording is not ERRORS):
            yield _row(label, one, other, wording.on(is_real=is_real))
    for label, spread, wording in _SPREADS:
        of_first, of_second = _apply(spread, first), _apply(spread, second)
        if of_first or of_second:
            row = _spread_row(label, of_first, of_second, wording.on(is_real=is_real))
            if wording is not RUNNING or (row.difference and row.assessment is not Assessment.SAME):
                yield row


ValueT = TypeVar("ValueT")


def _apply(function: Callable[[ValueT], ResultT | None], value: ValueT | None) -> ResultT | None:
    return None if value is None else function(value)


def _waited(side: CallbackInRun) -> _Spread | None:
    waits = side.figures.wait
    if waits is None and not side.longest_wait:
        return None
    return _Spread(None if waits is None else waits.median, side.longest_wait, side.lasts)


def _spread(values: Distribution | None, *, lasts: bool) -> _Spread | None:
    return None if values is None else _Spread(values.median, values.most, lasts)


_FIGURES: tuple[tuple[str, Callable[[CallbackInRun], Figure], Wording], ...] = (
    ("calls", lambda side: side.figures.calls, CALLS),
    ("errors", lambda side: side.figures.errors, ERRORS),
    ("lost", lambda side: side.figures.drops if side.figures.entity.depth else None, LOSSES),
)
_SPREADS: tuple[tuple[str, Callable[[CallbackInRun], _Spread | None], Wording], ...] = (
    ("takes med/max", lambda side: _spread(side.figures.duration, lasts=False), RUNNING),
    ("wait med/max", _waited, WAITS),
    ("age med/max", lambda side: _spread(side.figures.age, lasts=side.lasts), AGES),
    ("late med/max", lambda side: _spread(side.figures.late, lasts=side.lasts), LATENESS),
)


def _row(label: str, first: Figure, second: Figure, wording: Wording) -> ComparisonRow:
    figures = _format_both(wording.format, first, second)
    if first is None or second is None:
        return ComparisonRow(label, figures)
    return ComparisonRow(label, figures, *_difference(first, second, wording))


def _spread_row(label: str, first: _Spread | None, second: _Spread | None, wording: Wording) -> ComparisonRow:
    """A row of two spreads; the difference is that of the maxima, or of the medians if only these differ."""
    figures = _format_both(lambda spread: _spread_text(spread, wording), first, second)
    if first is None or second is None:
        return ComparisonRow(label, figures)
    if first.lasts and second.lasts:
        return ComparisonRow(label, figures, "goes on in both", Assessment.SAME)
    which = "max "
    text, assessment = _difference(first.most, second.most, wording)
    if assessment is Assessment.SAME and first.median is not None and second.median is not None:
        of_median = _difference(first.median, second.median, wording)
        if text == _SAME or of_median[1] is not Assessment.SAME:
            which, (text, assessment) = "med ", of_median
    return ComparisonRow(label, figures, text if assessment is Assessment.SAME else which + text, assessment)


def _spread_text(spread: _Spread, wording: Wording) -> str:
    median = NOTHING if spread.median is None else wording.format(spread.median)
    return f"{median} / {wording.format(spread.most)}"


def _difference(first: float, second: float, wording: Wording) -> tuple[str, Assessment]:
    """The difference as text, with the precision of the figures."""
    if wording.format(first) == wording.format(second):
        return _SAME, Assessment.SAME
    if wording.is_noise(first, second):
        return "about the same", Assessment.SAME
    step = second - first
    word = wording.higher if step > 0 else wording.lower
    assessment = Assessment.OTHER
    if wording.more_is_worse:
        assessment = Assessment.WORSE if step > 0 else Assessment.BETTER
    return f"{wording.format(abs(step))} {word}", assessment
