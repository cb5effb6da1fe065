"""A comparison of two runs as plain text: a column for each and one for the difference."""

from collections.abc import Iterator

from sim.trace.figures.comparison import Comparison
from sim.trace.figures.comparison_rows import (
    DIFFERENCE,
    RUNS,
    ComparisonRow,
    Section,
    ended_early,
    extent,
    sections,
    verdict,
)

_GAP = "  "


def comparison_text(
    comparison: Comparison, first: str, second: str, before: str = "", *, is_cured: bool = False
) -> str:
    """The whole comparison, ending in a newline; ``first`` and ``second`` are the runs' names.

    ``before`` is a sentence that comes before the verdict; ``is_cured`` is said in ``verdict()``.
    """
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
        f"{before} {ended_early(comparison) or verdict(comparison, is_cured=is_cured)}.".lstrip(),
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
    comparison: Comparison, first: str, second: str, before: str = "", *, is_cured: bool = False
) -> Iterator[str]:
    """Yield the whole comparison as lines that can be listened to; the same, for the rest."""
    yield from (f"{run}: {name}" for run, name in zip(RUNS, (first, second), strict=True))
    yield f"{before} {ended_early(comparison) or verdict(comparison, is_cured=is_cured)}.".lstrip()
    yield _extent(comparison)
    for section in sections(comparison):
        yield section.title
        for row in section.rows:
            label = row.label.replace(" med/max", ", median and longest")
            one, other = (figure.replace(" / ", " and ") for figure in row.figures)
            yield ", ".join(filter(None, (f"{label}: {RUNS[0]} {one}", f"{RUNS[1]} {other}", row.difference)))
        yield from section.notes
