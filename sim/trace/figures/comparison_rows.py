"""A comparison of two runs as rows of a table: both figures, the difference, and whether it is better."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple, TypeAlias, TypeVar

from sim.quantities.plural import counted
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
    WAITS,
    Wording,
    metres,
)
from sim.trace.figures.statistics import Distribution
from sim.trace.figures.summary import RobotFigures
from sim.trace.model import Nanoseconds, Window

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


Figure: TypeAlias = float | None


class _Spread(NamedTuple):
    """The median and the maximum."""

    median: Figure
    most: float


def sections(comparison: Comparison) -> tuple[Section, ...]:
    """The whole comparison: callback by callback, then the threads and the robot."""
    return (
        *(_section(pair, is_real=comparison.is_real) for pair in comparison.callbacks),
        Section("whole program", tuple(_whole(comparison.first, comparison.second))),
    )


def is_tie(comparison: Comparison) -> bool:
    """Whether neither run is better, though both were given the same commands."""
    return not comparison.unlike_commands and next(_differences(comparison), None) is None


def ended_early(comparison: Comparison) -> str:
    """Return which run an exception ended while the other one goes on, if only to one of its own; or "".

    Of such runs only the part before the exception can be compared, which speaks for no run.
    """
    runs = comparison.first, comparison.second
    for place, run in enumerate(runs):
        other = runs[1 - place]
        if run.crashes and not other.crashes and run.end <= comparison.window.end < other.end:
            told = f"{RUNS[place]} ended at {_seconds(run.end)} s with an exception"
            goes_on = f"; {RUNS[1 - place]} goes on"
            if other.fails:
                goes_on = f", and {RUNS[1 - place]} at {_seconds(other.end)} s with one"
            return f"{told[0].upper()}{told[1:]}{goes_on}"
    return ""


def verdict(comparison: Comparison, *, is_cured: bool = False) -> str:
    """Return which run is better and by what, in one sentence that also names what is worse.

    Errors weigh most, then subscriptions that do not match, losses, collisions, waits, lateness, and the age
    of data; a problem that is gone in the second run (``is_cured``) weighs more than all of them. Of runs
    that were not given the same commands, as calls of a service, it says that.
    """
    if comparison.unlike_commands:
        text, one, other = comparison.unlike_commands[0]
        given = f"{RUNS[0]} has {one or 'no'} '{text}', {RUNS[1]} has {other or 'none'}"
        same = "; cbtui compare --call SECONDS gives both the same" if text.startswith("call ") else ""
        return f"{given}: only with as many in both can one be better{same}"
    better: list[_FigureDifference] = []
    worse: list[_FigureDifference] = []
    for each in _differences(comparison):
        (better if each.second < each.first else worse).append(each)
    if not better and not worse:
        if comparison.is_real:
            return "Both runs are about the same: what differs may be the real clock's doing"
        return "Neither run is better: no callback fails, loses or waits more in one of them"
    is_better = min(map(_weight, better), default=_NONE) <= min(map(_weight, worse), default=_NONE)
    if is_cured and not is_better:
        also = f", and by {_listed(better)}" if better else ""
        return f"{RUNS[1]} is better by what is gone{also}; but {_listed(worse)}"
    for_it, against = (better, worse) if is_better else (worse, better)
    told = f"{RUNS[1]} is {'better' if is_better else 'worse'}: {_listed(for_it)}"
    return told + (f"; but {_listed(against)}" if against else "")


class _FigureDifference(NamedTuple):
    """A figure, of which less is better, that differs enough to speak for a run; ``rank`` 0 weighs most."""

    rank: int
    what: str
    first: float
    second: float
    wording: Wording

    @property
    def text(self) -> str:
        """Both figures in words."""
        first, second = self.wording.format(self.first), self.wording.format(self.second)
        return f"{self.what} {second} instead of {first}"


def _weight(difference: _FigureDifference) -> tuple[float, float]:
    return difference.rank, -abs(difference.second - difference.first)


def _listed(differences: Sequence[_FigureDifference]) -> str:
    first, *others = sorted(differences, key=_weight)
    more = f", and in {counted(len(others), 'more way')}" if others else ""
    return f"{first.text}{more}"


def _differences(comparison: Comparison) -> Iterator[_FigureDifference]:
    pairs = [(pair.name, pair.first, pair.second) for pair in comparison.callbacks]
    for rank, what, figure, wording, least in _DECIDING:
        for name, first, second in pairs:
            if first is not None and second is not None:
                one, other = figure(first), figure(second)
                lower, higher = (first, second) if one < other else (second, first)
                if wording.on(is_real=comparison.is_real).is_noise(one, other):
                    continue
                is_like = 2 * lower.figures.calls >= higher.figures.calls
                if (is_like or wording not in _OF_CALLS) and abs(other - one) >= least:
                    weight = rank if is_like or what != _LOST else _LEAST
                    yield _FigureDifference(weight, f"{what} of {name}", one, other, wording)
    for rank, what, count in _DECIDING_RUNS:
        one, other = count(comparison.first), count(comparison.second)
        if one != other:
            yield _FigureDifference(rank, what, one, other, FLAWS)


_NONE = (math.inf, 0.0)
_LEAST = 6
"""The rank of what weighs less than all else."""
_DECIDING_RUNS: tuple[tuple[int, str, Callable[[RunFigures], int]], ...] = (
    (0, "runs that an error ends", lambda run: run.crashes),
    (1, "subscriptions that hear nothing", lambda run: run.mismatches),
    (2, "collisions", lambda run: run.collisions),
)
_OF_CALLS = (LATENESS, AGES)
"""Figures of calls: lower ones of far fewer calls, as of a callback that hangs, speak for no run."""
_LOST = "losses"
"""Fewer in far fewer calls weigh least: who hangs sends nothing that could be lost."""
_NOTABLE = 10_000_000
"""Nanoseconds by which a wait or an age must differ."""


def _most(values: Distribution | None) -> float:
    return 0.0 if values is None else values.most


_DECIDING: tuple[tuple[int, str, Callable[[CallbackInRun], float], Wording, float], ...] = (
    (0, "errors", lambda side: side.figures.errors, ERRORS, 1),
    (2, _LOST, lambda side: side.figures.drops, LOSSES, 1),
    (3, "longest wait", lambda side: side.longest_wait, WAITS, _NOTABLE),
    (4, "worst lateness", lambda side: _most(side.figures.late), LATENESS, _NOTABLE),
    (5, "oldest data", lambda side: _most(side.figures.age), AGES, _NOTABLE),
)
"""Figures that decide a verdict, each with its rank, and by how much it must differ."""


def extent(window: Window, *ends: Nanoseconds, is_real: bool = False) -> str:
    """The compared part of runs with these ends: ``0 to 12.4 s; run A goes on to 20 s``."""
    parts = [stretch(window)]
    if is_real and not window.start:
        parts.append("each from its first call on")
    for name, end in zip(RUNS, ends, strict=True):
        if end > window.end:
            parts.append(f"{name} goes on to {_seconds(end)} s")
    return "; ".join(parts)


def stretch(window: Window) -> str:
    """A window as text: ``0 to 12.4 s``."""
    return f"{_seconds(window.start)} to {_seconds(window.end)} s"


def _seconds(nanoseconds: int) -> str:
    return f"{round(nanoseconds / 1e9, 3):g}" if nanoseconds < 100_000_000_000 else f"{nanoseconds / 1e9:.1f}"


def _whole(first: RunFigures, second: RunFigures) -> Iterator[ComparisonRow]:
    yield _row("threads used", first.threads_used, second.threads_used, COUNTS)
    yield _row("at once", first.threads_at_once, second.threads_at_once, COUNTS)
    robots = [run.robot for run in (first, second) if run.robot is not None]
    if len(robots) != 1 and all(map(_stands, robots)):
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
        if side and side.waits
    )
    return Section(title, tuple(_rows(first, second, is_real=is_real)), tuple(notes))


def _rows(
    first: CallbackInRun | None, second: CallbackInRun | None, *, is_real: bool
) -> Iterator[ComparisonRow]:
    for label, figure, wording in _FIGURES:
        one, other = _apply(figure, first), _apply(figure, second)
        if one is not None or other is not None:
            yield _row(label, one, other, wording.on(is_real=is_real))
    for label, spread, wording in _SPREADS:
        of_first, of_second = _apply(spread, first), _apply(spread, second)
        if of_first or of_second:
            yield _spread_row(label, of_first, of_second, wording.on(is_real=is_real))


ValueT = TypeVar("ValueT")


def _apply(function: Callable[[ValueT], ResultT | None], value: ValueT | None) -> ResultT | None:
    return None if value is None else function(value)


def _waited(side: CallbackInRun) -> _Spread | None:
    waits = side.figures.wait
    if waits is None and not side.longest_wait:
        return None
    return _Spread(None if waits is None else waits.median, side.longest_wait)


def _spread(values: Distribution | None) -> _Spread | None:
    return None if values is None else _Spread(values.median, values.most)


_FIGURES: tuple[tuple[str, Callable[[CallbackInRun], Figure], Wording], ...] = (
    ("calls", lambda side: side.figures.calls, CALLS),
    ("errors", lambda side: side.figures.errors or None, ERRORS),
    ("lost", lambda side: side.figures.drops if side.figures.entity.depth else None, LOSSES),
)
_SPREADS: tuple[tuple[str, Callable[[CallbackInRun], _Spread | None], Wording], ...] = (
    ("wait med/max", _waited, WAITS),
    ("age med/max", lambda side: _spread(side.figures.age), AGES),
    ("late med/max", lambda side: _spread(side.figures.late), LATENESS),
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
