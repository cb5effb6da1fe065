"""Colours in the output of commands, on terminals only; they repeat what signs and words say."""

import os
import re
from enum import Enum
from typing import TextIO


class Colour(Enum):
    """A colour of the terminal's own, by its number in escape sequences (ECMA-48, SGR)."""

    BAD = 31
    GOOD = 32
    WARNING = 33


_SIGNS = {"✓": Colour.GOOD, "✗": Colour.BAD, "!": Colour.WARNING}
_SIGN = re.compile(rf"^ *([{''.join(_SIGNS)}])(?= )", re.MULTILINE)
"""A sign at the beginning of a line."""


def coloured(text: str, colour: Colour | None, stream: TextIO) -> str:
    """Return the text, coloured if the stream is a terminal and NO_COLOR is not set."""
    if (
        colour is None
        or os.environ.get("NO_COLOR")
        or os.environ.get("TERM") == "dumb"
        or not stream.isatty()
    ):
        return text
    return f"\x1b[{colour.value}m{text}\x1b[0m"


def with_coloured_signs(text: str, stream: TextIO) -> str:
    """Return the text with the signs at the beginnings of its lines coloured."""
    return _SIGN.sub(lambda sign: coloured(sign[0], _SIGNS[sign[1]], stream), text)
