"""Replaces non-ASCII characters for terminals that show only ASCII."""

from functools import lru_cache
from unicodedata import normalize

from rich.cells import cell_len
from rich.segment import Segment
from textual.color import Color
from textual.filter import LineFilter

_SIGNS = dict(
    zip(
        "─━═│┃║┄┅┆┇┈┉┊┋╌╍╎╏╭╮╰╯╱╲╳●○◐■◂▸▶▲▼✓✗×·•▪‣…–—−‖“”‘’«»←→↑↓␣⏎◷◓◑◒µ",  # noqa: RUF001
        "--=|||--||--||--||++++/\\x*op#<>>^v+xx.***~---=\"\"''<><>^v_<@o*ou",
        strict=True,
    )
)

_BLOCKS = (
    ("\u2500", "\u257f", "+"),
    ("\u258a", "\u2590", "|"),
    ("\u2595", "\u2595", "|"),
    ("\u2580", "\u259f", "#"),
    ("\u2800", "\u2800", " "),
    ("\u2801", "\u28ff", "."),
)
"""Replacements of character ranges: lines, narrow and other blocks, braille."""


class AsciiFilter(LineFilter):
    """Replaces every non-ASCII character by a similar ASCII one of the same width."""

    def apply(self, segments: list[Segment], background: Color) -> list[Segment]:
        """Return the segments in ASCII; control segments stay."""
        return [Segment(in_ascii(text), style, control) for text, style, control in segments]


@lru_cache(maxsize=4096)
def in_ascii(text: str) -> str:
    """Return text of the same width in ASCII."""
    return text if text.isascii() else "".join(map(_plain, text))


def _plain(character: str) -> str:
    if character.isascii():
        return character
    if character in _SIGNS:
        return _SIGNS[character]
    for first, last, plain in _BLOCKS:
        if first <= character <= last:
            return plain
    base = normalize("NFKD", character)[0]
    return base if base.isascii() and cell_len(character) == 1 else "?" * cell_len(character)
