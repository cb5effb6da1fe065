"""Removes escape sequences from all text on the screen, so that no program can control the terminal."""

import re
from functools import lru_cache

from rich.cells import cell_len
from rich.segment import Segment
from textual.color import Color
from textual.filter import LineFilter

_OBEYED = re.compile(
    "[\x00-\x1f\x7f-\x9f\u200b\u200e\u200f\u202a-\u202e\u2060\u2066-\u2069\ud800-\udfff\ufeff]"
)
"""Control characters, bidirectional and invisible characters, and lone surrogates."""


class HarmlessFilter(LineFilter):
    """Replaces characters that a terminal would act on, keeping the width."""

    def apply(self, segments: list[Segment], background: Color) -> list[Segment]:
        """Return the segments without such characters; control segments stay."""
        if "".join([text for text, _, control in segments if not control]).isprintable():
            return segments
        return [
            segment if segment.control else Segment(harmless(segment.text), segment.style)
            for segment in segments
        ]


@lru_cache(maxsize=1024)
def harmless(text: str) -> str:
    """Return text of the same width that no terminal acts on."""
    return _OBEYED.sub(lambda found: "?" * cell_len(found[0]), text)
