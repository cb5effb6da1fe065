"""The keys that scroll the table of a comparison."""

from collections.abc import Callable
from dataclasses import dataclass

from cbtui.screens.parts.part import ScreenPart
from cbtui.widgets.comparison import ComparisonTable

_ROWS_A_KEY = 3


@dataclass
class TableScrolling(ScreenPart):
    """Scrolls the table, if not all of it is on screen."""

    table: Callable[[], ComparisonTable]

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer it where rows are out of sight."""
        return self.table().display and self.table().max_scroll_y > 0

    def action_scroll_table_up(self) -> None:
        """Scroll the table up."""
        self.table().scroll_relative(y=-_ROWS_A_KEY, animate=False)

    def action_scroll_table_down(self) -> None:
        """Scroll the table down."""
        self.table().scroll_relative(y=_ROWS_A_KEY, animate=False)

    def action_page_up(self) -> None:
        """Scroll the table up by a page."""
        self.table().scroll_page_up(animate=False)

    def action_page_down(self) -> None:
        """Scroll the table down by a page."""
        self.table().scroll_page_down(animate=False)
