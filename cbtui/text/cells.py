"""Text as terminal cells: a row of cells to paint on, and text made safe to display."""

import unicodedata
from functools import lru_cache
from itertools import groupby
from textwrap import wrap

from rich.cells import cell_len

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun
from cbtui.text.ascii_filter import in_ascii

BLANK = Ink(Role.TEXT)

_UNSHOWABLE = {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp", "Zs"}
_PICTURES = {chr(code): chr(0x2400 + code) for code in range(0x20)} | {"\x7f": "␡", "\xa0": " "}

_TAB = 8
MOST_COLUMNS = 90
"""The widest lines of running text that are read with ease."""


def lines_of_text(
    text: str, width: int, charset: Charset = Charset.BRAILLE, most: int = MOST_COLUMNS
) -> list[str]:
    """Break running text, made safe to display, into lines of ``width`` columns at most, or of ``most``.

    A last word that would be left alone on its line takes the one before it along.
    """
    shown, width = visible(text, charset), min(width, most)
    lines = wrap(shown, width, break_on_hyphens=False)
    if len(lines) > 1 and " " not in lines[-1] and " " in lines[-2]:
        before, _, taken = lines[-2].rpartition(" ")
        if len(taken) + 1 + len(lines[-1]) <= width:
            lines[-2:] = [before, f"{taken} {lines[-1]}"]
    return lines


def visible(text: str, charset: Charset) -> str:
    """Return text that a terminal displays and never acts on.

    Control characters become their pictures (␛ for escape), other invisible characters and lone surrogates
    the replacement character; in ASCII these become ``?``, and letters and signs similar ones.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(_shown(character, charset) for character in unicodedata.normalize("NFC", text))


def without_tabs(text: str) -> str:
    """Return text with tabs expanded to multiples of 8 columns."""
    first, *others = text.split("\t")
    for part in others:
        column = cell_len(first.rpartition("\n")[2])
        first += " " * (_TAB - column % _TAB) + part
    return first


def _shown(character: str, charset: Charset) -> str:
    if character.isascii() and character.isprintable():
        return character
    if charset is Charset.ASCII:
        return "?" if character.isascii() else in_ascii(character) or "?"
    if character in _PICTURES:
        return _PICTURES[character]
    unshowable = unicodedata.category(character) in _UNSHOWABLE or cell_len(character) == 0
    return "�" if unshowable else character


@lru_cache(maxsize=1024)
def to_cells(text: str, charset: Charset) -> tuple[str, ...]:
    """Return one string per column; a wide character is followed by an empty string."""
    cells: list[str] = []
    for character in visible(text, charset):
        cells.append(character)
        cells.extend([""] * (cell_len(character) - 1))
    return tuple(cells)


@lru_cache(maxsize=1024)
def fit(text: str, width: int, charset: Charset) -> str:
    """Return the text in exactly ``width`` columns: padded, or cut with an ellipsis."""
    cells = to_cells(text, charset)
    if len(cells) <= width:
        return "".join(cells) + " " * (width - len(cells))
    if width <= 0:
        return ""
    kept = list(cells[: width - 1])
    if cells[width - 1] == "":
        kept[-1:] = " "
    return "".join(kept) + GLYPHS[charset].ellipsis


class CellRow:
    """One line of a picture that is being painted: a glyph and an ink per column."""

    __slots__ = ("cells", "charset", "inks")

    def __init__(self, width: int, charset: Charset) -> None:
        self.charset = charset
        self.cells = [" "] * width
        self.inks = [BLANK] * width

    def copy(self) -> "CellRow":
        """Return a row that can be painted on without changing this one."""
        row = CellRow(0, self.charset)
        row.cells, row.inks = self.cells.copy(), self.inks.copy()
        return row

    def put(self, column: int, glyph: str, ink: Ink) -> None:
        """Put a glyph of one column's width at a column; columns outside of the row are ignored."""
        if not 0 <= column < len(self.cells):
            return
        if self.cells[column] == "":
            self.cells[column - 1] = " "
        if column + 1 < len(self.cells) and self.cells[column + 1] == "":
            self.cells[column + 1] = " "
        self.cells[column] = glyph
        self.inks[column] = ink

    def fill(self, start: int, end: int, glyph: str, ink: Ink) -> None:
        """Put the same glyph in the columns from ``start`` to before ``end``; both lie in the row."""
        self.cells[start:end] = [glyph] * (end - start)
        self.inks[start:end] = [ink] * (end - start)

    def write(self, start: int, text: str, ink: Ink) -> None:
        """Write text from a column on; it is cut at the row's end."""
        room = max(0, len(self.cells) - start)
        cells = to_cells(fit(text, room, self.charset).rstrip() if len(text) > room else text, self.charset)
        self.cells[start : start + len(cells)] = cells
        self.inks[start : start + len(cells)] = [ink] * len(cells)

    def blank(self, start: int, end: int) -> bool:
        """Tell whether the columns from ``start`` to before ``end`` are in the row and still blank."""
        return start >= 0 and end <= len(self.cells) and all(ink is BLANK for ink in self.inks[start:end])

    def runs(self) -> list[TextRun]:
        """Return the row as runs of one ink each."""
        runs: list[TextRun] = []
        at = 0
        for ink, same in groupby(self.inks):
            end = at + len(list(same))
            runs.append(TextRun("".join(self.cells[at:end]), ink))
            at = end
        return runs
