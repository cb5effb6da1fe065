"""Greys in place of colours, for whoever sets NO_COLOR."""

from functools import lru_cache
from math import ceil, floor

from rich.color import Color
from rich.segment import Segment
from rich.style import Style
from textual.color import Color as TextualColour
from textual.filter import LineFilter

from cbtui.looks.contrast import luminance

_MIDDLE = 0.18
"""The luminance at which black and white contrast alike."""


class GreyFilter(LineFilter):
    """Replaces each colour by the grey of its luminance, so that every contrast stays.

    Textual's own greys are weighted sums of the channels, by which contrasts shrink.
    """

    def apply(self, segments: list[Segment], background: TextualColour) -> list[Segment]:
        """Return the segments in greys; control segments stay."""
        return [Segment(text, style and _in_greys(style), control) for text, style, control in segments]


@lru_cache(maxsize=1024)
def _in_greys(style: Style) -> Style:
    return style + Style(color=_grey(style.color), bgcolor=_grey(style.bgcolor))


def _grey(colour: Color | None) -> Color | None:
    """Return a colour's grey, rounded away from the middle; the terminal's own colour stays."""
    if colour is None or colour.is_default:
        return colour
    bright = luminance(colour.get_truecolor())
    share = bright * 12.92 if bright <= 0.0031308 else 1.055 * bright ** (1 / 2.4) - 0.055
    level = min(255, (ceil if bright > _MIDDLE else floor)(round(share * 255, 6)))
    return Color.from_rgb(level, level, level)
