"""Pictures made of dots smaller than a cell: braille, quarter blocks, or one sign a cell in ASCII."""

from collections.abc import Sequence
from copy import copy

import numpy as np
from numpy.typing import NDArray

from cbtui.looks.theme import Charset, Ink
from cbtui.text.cells import CellRow

Floats = NDArray[np.float64]
Layers = NDArray[np.uint8]

_BRAILLE = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]], dtype=np.int32)
_QUARTERS = np.array([[1, 2], [4, 8]], dtype=np.int32)
_QUARTER_GLYPHS = " ▘▝▀▖▌▞▛▗▚▐▜▄▙▟█"

DOTS_PER_CELL = {Charset.BRAILLE: (2, 4), Charset.BLOCK: (2, 2), Charset.ASCII: (1, 1)}
"""Dots across and down in one cell."""


class DotGrid:
    """A grid of dots over cells, each blank or of one layer; the highest layer in a cell gives its ink.

    Coordinates count dots from the top left, as floats; what lies outside the grid is left out.
    """

    def __init__(self, width: int, height: int, charset: Charset) -> None:
        self._charset = charset
        self.across, self.down = DOTS_PER_CELL[charset]
        self._layers = np.zeros((height * self.down, width * self.across), dtype=np.uint8)

    def copy(self) -> "DotGrid":
        """Return a grid with the same dots."""
        other = copy(self)
        other._layers = self._layers.copy()
        return other

    def plot(self, x: Floats, y: Floats, layer: int | Layers) -> None:
        """Set dots in one layer, or each in its own; these must not descend."""
        inside = self._inside(x, y)
        self._set(x, y, inside, layer if isinstance(layer, int) else layer[inside])

    def plot_sparsely(self, x: Floats, y: Floats, layer: int) -> None:
        """Set every other dot, in a chequer."""
        self._set(x, y, self._inside(x, y) & ((np.floor(x) + np.floor(y)) % 2 == 0), layer)

    def line(self, start: tuple[float, float], end: tuple[float, float], layer: int) -> None:
        """Set the dots from one point to another."""
        steps = int(max(abs(end[0] - start[0]), abs(end[1] - start[1]))) + 2
        steps = min(steps, 4 * sum(self._layers.shape))
        self.plot(np.linspace(start[0], end[0], steps), np.linspace(start[1], end[1], steps), layer)

    def rows(self, inks: Sequence[Ink], signs: str) -> list[CellRow]:
        """Return the picture; ``inks`` and ``signs`` (for ASCII) are those of layers 0, 1, …; 0 is blank.

        Blank cells take the ink of the cell before them: fewer runs mean less output to the terminal.
        """
        lines, dots = self._layers.shape
        cells = self._layers.reshape(lines // self.down, self.down, dots // self.across, self.across)
        tops = cells.max(axis=(1, 3))
        rows = []
        for glyphs, layers in zip(self._glyphs(cells, tops, signs), _carried_on(tops).tolist(), strict=True):
            row = CellRow(len(layers), self._charset)
            row.cells = list(glyphs)
            row.inks = list(map(inks.__getitem__, layers))
            rows.append(row)
        return rows

    def _glyphs(self, cells: Layers, tops: Layers, signs: str) -> list[str]:
        if self._charset is Charset.ASCII:
            return ["".join(signs[layer] for layer in row) for row in tops.tolist()]
        weights = _BRAILLE if self._charset is Charset.BRAILLE else _QUARTERS
        codes = ((cells > 0) * weights[:, None, :]).sum(axis=(1, 3))
        if self._charset is Charset.BLOCK:
            return ["".join(_QUARTER_GLYPHS[code] for code in row) for row in codes.tolist()]
        characters = np.where(codes > 0, 0x2800 + codes, ord(" ")).astype("<u4")
        return [row.tobytes().decode("utf-32-le") for row in characters]

    def _inside(self, x: Floats, y: Floats) -> NDArray[np.bool_]:
        lines, dots = self._layers.shape
        return (x >= 0) & (x < dots) & (y >= 0) & (y < lines)

    def _set(self, x: Floats, y: Floats, chosen: NDArray[np.bool_], layer: int | Layers) -> None:
        dots = y[chosen].astype(np.int64), x[chosen].astype(np.int64)
        self._layers[dots] = np.maximum(self._layers[dots], layer)


def _carried_on(layers: Layers) -> Layers:
    """Return rows of layers in which every 0 is replaced by the layer before it."""
    columns = np.arange(layers.shape[1])
    last = np.maximum.accumulate(np.where(layers > 0, columns, 0), axis=1)
    return np.take_along_axis(layers, last, axis=1)
