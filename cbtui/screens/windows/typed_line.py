"""Windows that ask for a line of text, and explain a refusal."""

from collections.abc import Callable

from textual.content import Content
from textual.widgets import Input, Static

from cbtui.screens.sized import Result
from cbtui.screens.windows.window import WindowScreen


class TypedLine(Input):
    """A line to type; ``take`` gets it when it is submitted, and raises ValueError for what is refused."""

    def __init__(self, text: str, take: Callable[[str], None], placeholder: str = "") -> None:
        super().__init__(text, placeholder=placeholder, compact=True)
        self._take = take
        self.refusal = Static(id="wrong")
        """A widget for the window to lay out: why the last line was refused."""

    async def action_submit(self) -> None:
        """Hand the text over, or show why it is refused."""
        try:
            self._take(self.value)
        except ValueError as error:
            self.refusal.update(Content(f"{error}."))


class LineScreen(WindowScreen[Result]):
    """A window with one ``TypedLine``."""

    async def action_go(self) -> None:
        """Submit the line."""
        await self.query_one(TypedLine).action_submit()
