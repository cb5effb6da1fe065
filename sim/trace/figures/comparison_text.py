"""A comparison of two runs as plain text: a column for each and one for the difference."""

import textwrap
from collections.abc import Iterator

from sim.trace.figures.comparison import Comparison
from sim.trace.figures.comparison_rows import (
    DIFFERENCE,
    RUNS,
    ComparisonRow,
    Section,
    sections,
)
from sim.trace.figures.comparison_sentences import NO_PROBLEMS, Problems, extent, headline

_GAP = "  "
_WIDTH = 80


def comparison_text(comparison: Comparison, first: str, second: str, problems: Problems = NO_PROBLEMS) -> str:
    """The whole comparison, ending in a newline; ``first`` and ``second`` are the runs' names."""
    shown = sections(comparison)
    head = ComparisonRow("", RUNS, DIFFERENCE)
    rows = [head, *(row for section in shown for row in section.rows)]
    widths = (
        max(len(row.label) for row in rows) + len(_GAP),
        max(len(row.figures[0]) for row in rows),
        max(len(row.figures[1]) for row in rows),
    )
    lines = [
        f"{RUNS[0]}  {first}",
        f"{RUNS[1]}  {second}",
        _extent(comparison),
        *textwrap.wrap(headline(comparison, problems), _WIDTH, break_on_hyphens=False),
        "",
        _line(head, widths),
    ]
    for section in shown:
        lines += ["", *_lines(section, widths)]
    return "".join(f"{line}\n" for line in lines)


def _extent(comparison: Comparison) -> str:
    return extent(comparison.window, comparison.first.end, comparison.second.end, is_real=comparison.is_real)


def _lines(section: Section, widths: tuple[int, int, int]) -> Iterator[str]:
    yield section.title
    for row in section.rows:
        yield _line(row, widths)
    for note in section.notes:
        yield f"{_GAP}{note}"


def _line(row: ComparisonRow, widths: tuple[int, int, int]) -> str:
    label, first, second = widths
    cells = (
        f"{_GAP if row.label else ''}{row.label}".ljust(label),
        row.figures[0].ljust(first),
        row.figures[1].ljust(second),
        row.difference,
    )
    return _GAP.join(cells).rstrip()


def comparison_lines(
    comparison: Comparison, first: str, second: str, problems: Problems = NO_PROBLEMS
) -> Iterator[str]:
    """Yield the whole comparison as lines that can be listened to; the same, for the rest."""
    yield from (f"{run}: {name}" for run, name in zip(RUNS, (first, second), strict=True))
    yield headline(comparison, problems)
    yield _extent(comparison)
    for section in sections(comparison):
        yield section.title
        for row in section.rows:
            label = row.label.replace(" med/max", ", median and longest")
            one, other = (figure.replace(" / ", " and ") for figure in row.figures)
            yield ", ".join(filter(None, (f"{label}: {RUNS[0]} {one}", f"{RUNS[1]} {other}", row.difference)))
        yield from section.notes
