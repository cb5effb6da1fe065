"""Paints the table of a comparison as rows of text in inks: sections below each other, in columns if wide."""

from collections.abc import Iterator, Sequence

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun
from cbtui.text.cells import fit
from sim.trace.figures.comparison_rows import DIFFERENCE, RUNS, Assessment, ComparisonRow, Section

_PLAIN = Ink(Role.TEXT)
_FAINT = Ink(Role.FAINT)
_STRONG = Ink(Role.STRONG)
_DIFFERENCES = {
    Assessment.SAME: _FAINT,
    Assessment.OTHER: _PLAIN,
    Assessment.BETTER: _STRONG,
    Assessment.WORSE: Ink(Role.WARN),
}

_LABEL, _FIGURE, _DIFFERENCE = 18, 16, 19
BLOCK = _LABEL + 2 * _FIGURE + _DIFFERENCE
"""Columns that a section needs at least."""
_GAP = TextRun(" ", _PLAIN)

StyledLine = list[TextRun]


def headings(width: int, charset: Charset) -> StyledLine:
    """Return the line that names the columns, in exactly ``width`` columns."""
    row = ComparisonRow("", RUNS, DIFFERENCE)
    return _side_by_side([[_cells(row, each, charset)] for each in _blocks(width)], width)[0]


def table(sections: Sequence[Section], width: int, charset: Charset) -> list[StyledLine]:
    """Return the lines of a comparison, each in exactly ``width`` columns."""
    blocks = _blocks(width)
    columns = _shared_out([(section, _height(section)) for section in sections], len(blocks))
    painted = [
        [line for section in column for line in _section(section, block, charset)][:-1]
        for column, block in zip(columns, blocks, strict=True)
    ]
    return _side_by_side(painted, width)


def _blocks(width: int) -> list[int]:
    """The widths of the columns of sections, a gap between each two."""
    count = max(1, (width + 1) // (BLOCK + 1))
    return [(width - count + 1) // count] * count


def _height(section: Section) -> int:
    return 2 + len(section.rows) + len(section.notes)


def _shared_out(sections: Sequence[tuple[Section, int]], count: int) -> list[list[Section]]:
    """Fill columns one after the other, so that the highest column is as low as possible."""
    limit = -(-sum(height for _, height in sections) // count)
    while (columns := _filled(sections, limit)) is None or len(columns) > count:
        limit += 1
    return columns + [[] for _ in range(count - len(columns))]


def _filled(sections: Sequence[tuple[Section, int]], limit: int) -> list[list[Section]] | None:
    """The sections in columns of at most ``limit`` lines; None if one is higher than that."""
    columns: list[list[Section]] = [[]]
    used = 0
    for section, height in sections:
        if height > limit:
            return None
        if used + height > limit:
            columns.append([])
            used = 0
        columns[-1].append(section)
        used += height
    return columns


def _section(section: Section, width: int, charset: Charset) -> Iterator[StyledLine]:
    yield [TextRun(fit(section.title, width, charset), _STRONG)]
    for row in section.rows:
        yield _cells(row, width, charset)
    for note in section.notes:
        yield [TextRun(fit(f" {note}", width, charset), _FAINT)]
    yield [TextRun(" " * width, _PLAIN)]


def _cells(row: ComparisonRow, width: int, charset: Charset) -> StyledLine:
    """A row in exactly ``width`` columns; the difference gets the room that the other cells leave."""
    first, second = row.figures
    cells = (
        (f" {row.label}", _LABEL, _FAINT),
        (first, _FIGURE, _PLAIN),
        (second, _FIGURE, _PLAIN),
        (row.difference, width, _DIFFERENCES[row.assessment]),
    )
    line: StyledLine = []
    room = width
    for text, wanted, ink in cells:
        taken = min(wanted, room)
        line.append(TextRun(fit(_shown(text, charset), taken, charset), ink))
        room -= taken
    return line


def _shown(text: str, charset: Charset) -> str:
    return text.replace("°", GLYPHS[charset].degree)


def _side_by_side(columns: Sequence[Sequence[StyledLine]], width: int) -> list[StyledLine]:
    widths = _blocks(width)
    lines = []
    for place in range(max(map(len, columns))):
        line: StyledLine = []
        for column, block in zip(columns, widths, strict=True):
            line += column[place] if place < len(column) else [TextRun(" " * block, _PLAIN)]
            line.append(_GAP)
        line.pop()
        taken = sum(widths) + len(widths) - 1
        lines.append([*line, TextRun(" " * (width - taken), _PLAIN)])
    return lines
