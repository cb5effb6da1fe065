"""The search line of the menu."""

from typing import ClassVar

from textual.binding import BindingType
from textual.message import Message
from textual.widgets import Input

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of


class MenuSearch(Input):
    """The input of the search; up and down move the list's highlight."""

    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.SEARCH)]

    class SearchCleared(Message):
        """The search was cancelled."""

    class HighlightMoved(Message):
        """The user wants to move the list's highlight up (``step`` < 0) or down."""

        def __init__(self, step: int) -> None:
            super().__init__()
            self.step = step

    def __init__(self) -> None:
        super().__init__(placeholder="words to look for", compact=True, select_on_focus=False)

    def action_above(self) -> None:
        """Go up the list."""
        self.post_message(self.HighlightMoved(-1))

    def action_below(self) -> None:
        """Go down the list."""
        self.post_message(self.HighlightMoved(1))

    def action_give_up(self) -> None:
        """Cancel the search."""
        self.post_message(self.SearchCleared())
