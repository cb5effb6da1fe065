"""A list of choices in a window, which a terminal may be too small to show."""

from textual.widgets import OptionList


class PageableOptionList(OptionList):
    """Textual's list, except that paging through it does nothing where none of it is shown.

    Textual looks for the lines of the highlighted choice then, and there are none.
    """

    def action_page_up(self) -> None:
        """Move the highlight up by a page."""
        if self.scrollable_content_region.height > 0:
            super().action_page_up()  # type: ignore[no-untyped-call]

    def action_page_down(self) -> None:
        """Move the highlight down by a page."""
        if self.scrollable_content_region.height > 0:
            super().action_page_down()  # type: ignore[no-untyped-call]
