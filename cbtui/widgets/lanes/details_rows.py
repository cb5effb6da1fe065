"""The rows below the lanes that describe the selected bar."""

from collections.abc import Sequence

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun
from cbtui.text.cells import fit, visible
from cbtui.widgets.lanes.details import BarDetails

ROWS = 2
"""The number of rows; constant, so that the screen does not jump from bar to bar."""

_TITLE = Ink(Role.STRONG)
_FACT = Ink(Role.TEXT)


def details_rows(details: BarDetails, width: int, charset: Charset) -> list[list[TextRun]]:
    """Return the rows, each in exactly ``width`` columns; what does not fit is cut off at the end."""
    glyphs = GLYPHS[charset]
    title = f"{glyphs.forth} {visible(details.title, charset)}"
    between = f" {glyphs.between} "
    lines = _wrapped([title, *(visible(fact, charset) for fact in details.facts)], between, width)
    rows = [[TextRun(fit(line, width, charset), _FACT)] for line in lines[:ROWS]]
    rows += [[TextRun(" " * width, _FACT)]] * (ROWS - len(rows))
    shown = len(title) if len(title) < width else width
    first = rows[0][0].text
    rows[0] = [TextRun(first[:shown], _TITLE), TextRun(first[shown:], _FACT)]
    return rows


def _wrapped(parts: Sequence[str], between: str, width: int) -> list[str]:
    """Distribute the parts over lines without splitting one; the last line may be too long."""
    lines = [parts[0]]
    for part in parts[1:]:
        if len(lines[-1]) + len(between) + len(part) <= width or len(lines) == ROWS:
            lines[-1] += between + part
        else:
            lines.append(f"  {part}")
    return lines
