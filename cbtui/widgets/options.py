"""A list of choices in a window, which a terminal may be too small to show."""

from typing import Literal

from textual.widgets import OptionList


class Options(OptionList):
    """Textual's list, except that paging through it does nothing where none of it is shown.

    Textual looks for the lines of the highlighted choice then, and there are none.
    """

    def _move_page(self, direction: Literal[-1, 1]) -> None:
        if self.scrollable_content_region.height > 0:
            super()._move_page(direction)
