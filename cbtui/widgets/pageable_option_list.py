"""An option list that tolerates paging while it has no visible rows."""

from textual.widgets import OptionList


class PageableOptionList(OptionList):
    """Textual's list, except that paging does nothing while no row is visible, which fails in Textual."""

    def action_page_up(self) -> None:
        """Move the highlight up by a page."""
        if self.scrollable_content_region.height > 0:
            super().action_page_up()  # type: ignore[no-untyped-call]

    def action_page_down(self) -> None:
        """Move the highlight down by a page."""
        if self.scrollable_content_region.height > 0:
            super().action_page_down()  # type: ignore[no-untyped-call]
