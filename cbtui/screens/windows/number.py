"""The window that asks for a number of a run's set-up."""

from collections.abc import Callable

from textual import on
from textual.app import ComposeResult
from textual.content import Content
from textual.widgets import Input, Static

from cbtui.keys.action import Scope
from cbtui.looks.theme import Charset
from cbtui.runs.setup.quantities import BadQuantityError, Quantity
from cbtui.screens.windows.typed_line import TypedLine
from cbtui.screens.windows.window import WindowScreen


class NumberScreen(WindowScreen[tuple[float | None]]):
    """Its result is a tuple with the number, or with None for the program's own; None if it was closed.

    ``code`` returns the line of a program for a number.
    """

    SCOPE = Scope.NUMBER

    def __init__(
        self, title: str, quantity: Quantity, now: float, code: Callable[[float], str], charset: Charset
    ) -> None:
        super().__init__(charset)
        self.heading = Content(title)
        self._quantity = quantity
        self._now = now
        self._code = code

    def content(self) -> ComposeResult:
        """Lay out the question."""
        quantity = self._quantity
        yield Static(f"Which {quantity.name}? Give {quantity.bounds}, or nothing for the program's own.")
        line = TypedLine(f"{self._now:g}", self._take)
        yield line
        yield Static(classes="code")
        yield line.refusal

    async def action_go(self) -> None:
        """Take what was typed."""
        await self.query_one(TypedLine).action_submit()

    @on(Input.Changed)
    def _show_code(self, event: Input.Changed) -> None:
        self.query_one(TypedLine).refusal.update("")
        try:
            code = self._code(self._quantity.read(event.value))
        except BadQuantityError:
            code = ""
        self.query_one(".code", Static).update(Content(code))

    def _take(self, text: str) -> None:
        self.dismiss((self._quantity.read(text) if text.strip() else None,))
