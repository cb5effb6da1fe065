"""The layout of a screen by the terminal's size."""

from enum import StrEnum

from textual.geometry import Size

LEAST = Size(80, 24)
"""The smallest terminal that the console draws in."""

GRID_FROM = Size(120, 34)
"""The smallest terminal in which every pane is shown at once."""


class Layout(StrEnum):
    """A screen's layout; the value is its style class."""

    SMALL = "-small"
    TABBED = "-tabbed"
    GRID = "-grid"


def layout_for(size: Size) -> Layout:
    """Return the layout for a terminal of a size."""
    if size.width < LEAST.width or size.height < LEAST.height:
        return Layout.SMALL
    if size.width < GRID_FROM.width or size.height < GRID_FROM.height:
        return Layout.TABBED
    return Layout.GRID


def too_small(size: Size) -> str:
    """Return the sentence for a terminal that is too small."""
    return (
        f"cbtui needs a terminal of {LEAST.width} columns and {LEAST.height} rows; "
        f"this one has {size.width} columns and {size.height} rows."
    )
