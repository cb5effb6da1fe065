"""A picture's pixels as cells of a terminal: two coloured pixels a cell, or characters by brightness."""

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from rich.color import Color
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from sim.camera import Picture

_RAMP = " .:-=+*#%@"
_DARKEST, _BRIGHTEST = 20, 240
"""Brightness, of 255, at which the emptiest and the densest character are reached."""
_RED, _GREEN, _BLUE = 0.2126, 0.7152, 0.0722
"""The weights of the colours in perceived brightness (ITU-R BT.709)."""

_BITS = 3
_TOP_LEVEL = (1 << _BITS) - 1
_PIXEL = 3 * _BITS


def half_blocks(picture: Picture) -> list[Strip]:
    """Return strips of upper half blocks in colours of 3 bits a channel; the picture's height is even."""
    levels = (_channels(picture).astype(np.int32) * _TOP_LEVEL + 127) // 255
    codes = levels[..., 0] << 2 * _BITS | levels[..., 1] << _BITS | levels[..., 2]
    pairs = codes[0::2] << _PIXEL | codes[1::2]
    return [_runs(row) for row in pairs]


def ramp(picture: Picture, dark: bool, style: Style) -> list[Strip]:
    """Return strips of characters in one style; on a dark ground bright pixels are dense, on a light one dark
    pixels.

    The picture's height must be even.
    """
    signs = _RAMP if dark else _RAMP[::-1]
    brightness = _channels(picture) @ np.array([_RED, _GREEN, _BLUE])
    cells = (brightness[0::2] + brightness[1::2]) / 2
    shares = (cells - _DARKEST) / (_BRIGHTEST - _DARKEST)
    steps = (shares * len(signs)).astype(np.int32).clip(0, len(signs) - 1).tolist()
    return [Strip([Segment("".join(signs[step] for step in row), style)], picture.width) for row in steps]


def _channels(picture: Picture) -> NDArray[np.uint8]:
    return np.frombuffer(picture.pixels, dtype=np.uint8).reshape(picture.height, picture.width, 3)


def _runs(pairs: NDArray[np.int32]) -> Strip:
    """Return one row of cells, neighbours of the same colours in one segment."""
    width = len(pairs)
    starts = [0, *(np.flatnonzero(np.diff(pairs)) + 1).tolist()]
    colours: Sequence[int] = pairs[starts].tolist()
    lengths = [end - start for start, end in pairwise((*starts, width))]
    return Strip([_segment(pair, length) for pair, length in zip(colours, lengths, strict=True)], width)


@lru_cache(maxsize=8192)
def _segment(pair: int, length: int) -> Segment:
    return Segment("▀" * length, _style(pair))


@lru_cache(maxsize=8192)
def _style(pair: int) -> Style:
    return Style(color=_colour(pair >> _PIXEL), bgcolor=_colour(pair & (1 << _PIXEL) - 1))


@lru_cache(maxsize=1 << _PIXEL)
def _colour(code: int) -> Color:
    levels = (code >> 2 * _BITS, code >> _BITS & _TOP_LEVEL, code & _TOP_LEVEL)
    return Color.from_rgb(*(level * 255 // _TOP_LEVEL for level in levels))
