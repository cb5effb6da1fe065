"""The rows below the lanes that tell of the selected bar."""

from collections.abc import Sequence

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun
from cbtui.text.cells import fit, visible
from cbtui.widgets.lanes.details import BarDetails

ROWS = 2
"""How many there are; always as many, so that the screen does not jump from one bar to the next."""

_TITLE = Ink(Role.STRONG)
_FACT = Ink(Role.TEXT)


def details_rows(details: BarDetails, width: int, charset: Charset) -> list[list[TextRun]]:
    """Return the rows, each in exactly ``width`` columns; what there is no room for is cut off at the end."""
    glyphs = GLYPHS[charset]
    title = f"{glyphs.forth} {visible(details.title, charset)}"
    between = f" {glyphs.between} "
    lines = _broken([title, *(visible(fact, charset) for fact in details.facts)], between, width)
    rows = [[TextRun(fit(line, width, charset), _FACT)] for line in lines[:ROWS]]
    rows += [[TextRun(" " * width, _FACT)]] * (ROWS - len(rows))
    shown = len(title) if len(title) < width else width
    first = rows[0][0].text
    rows[0] = [TextRun(first[:shown], _TITLE), TextRun(first[shown:], _FACT)]
    return rows


def _broken(parts: Sequence[str], between: str, width: int) -> list[str]:
    """Return the parts on lines, broken between parts; the last line may be too long."""
    lines = [parts[0]]
    for part in parts[1:]:
        if len(lines[-1]) + len(between) + len(part) <= width or len(lines) == ROWS:
            lines[-1] += between + part
        else:
            lines.append(f"  {part}")
    return lines
