"""A comparison of two runs as plain text: a column for each, 80 wide where names allow."""

import math
from collections.abc import Iterator

from sim.trace.comparison import Comparison, Pair, RunFigures, Side
from sim.trace.statistics import Distribution
from sim.trace.summary import RobotFigures
from sim.trace.summary_text import duration

_LABEL, _COLUMN = 20, 29
_NOTHING = "-"


def comparison_text(comparison: Comparison, first: str, second: str) -> str:
    """The whole comparison, ending in a newline; ``first`` and ``second`` are what the runs are called."""
    lines = [
        f"A  {first}",
        f"B  {second}",
        f"from {comparison.window.start / 1e9:g} s to {comparison.window.end / 1e9:g} s",
        "",
        _row("", "A", "B"),
        *_whole(comparison.first, comparison.second),
    ]
    for pair in comparison.callbacks:
        lines += ["", *_pair(pair)]
    return "".join(f"{line}\n" for line in lines)


def _row(label: str, first: str, second: str) -> str:
    return f"{label:{_LABEL}}  {first:{_COLUMN}}{second}".rstrip()


def _whole(first: RunFigures, second: RunFigures) -> Iterator[str]:
    yield _row("threads", _threads(first), _threads(second))
    if first.robot or second.robot:
        for label, a, b in zip(
            ("robot turned", "robot travelled", "robot is at"),
            _robot(first.robot),
            _robot(second.robot),
            strict=True,
        ):
            yield _row(label, a, b)


def _threads(figures: RunFigures) -> str:
    return f"{figures.threads_used} used, {figures.threads_at_once} at once"


def _robot(figures: RobotFigures | None) -> tuple[str, str, str]:
    if figures is None:
        return (_NOTHING,) * 3
    turns = f"{figures.turns} turn{'' if figures.turns == 1 else 's'}"
    heading = round(math.degrees(figures.yaw)) + 0
    return (
        f"{turns} ({figures.turned:.1f} rad)" if figures.turns else turns,
        f"{figures.travelled:.2f} m",
        f"x {round(figures.x, 2) + 0.0:.2f} y {round(figures.y, 2) + 0.0:.2f} heading {heading}°",
    )


def _pair(pair: Pair) -> Iterator[str]:
    yield pair.name
    first, second = _figures(pair.first), _figures(pair.second)
    for label in first:
        if first[label] != _NOTHING or second[label] != _NOTHING:
            yield _row(f"  {label}", first[label], second[label])
    for letter, side in (("A", pair.first), ("B", pair.second)):
        if side is not None and side.waits is not None:
            yield f"  {letter} waits: {side.waits.why}"


def _figures(side: Side | None) -> dict[str, str]:
    if side is None:
        return dict.fromkeys(("calls", "longest wait", "waits in all", "drops", "data age", "late"), _NOTHING)
    figures, waits = side.figures, side.waits
    return {
        "calls": str(figures.calls),
        "longest wait": _NOTHING if waits is None else duration(waits.longest),
        "waits in all": _NOTHING if waits is None else duration(waits.total),
        "drops": str(figures.drops) if figures.entity.depth else _NOTHING,
        "data age": _usual(figures.age),
        "late": _usual(figures.late),
    }


def _usual(ages: Distribution | None) -> str:
    if ages is None:
        return _NOTHING
    return f"{duration(ages.median)}, at most {duration(ages.most)}"
