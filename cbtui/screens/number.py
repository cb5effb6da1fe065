"""The window that asks for a number of a run's set-up."""

from collections.abc import Callable

from textual import on
from textual.app import ComposeResult
from textual.content import Content
from textual.widgets import Input, Static

from cbtui.keys.action import Scope
from cbtui.looks.theme import Charset
from cbtui.runs.setup.quantities import BadQuantityError, Quantity
from cbtui.screens.window import WindowScreen


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
        yield Input(f"{self._now:g}", compact=True)
        yield Static(classes="code")
        yield Static(id="wrong")

    def action_go(self) -> None:
        """Take what was typed."""
        self._take(self.query_one(Input).value)

    @on(Input.Changed)
    def _show_code(self, event: Input.Changed) -> None:
        self.query_one("#wrong", Static).update("")
        try:
            code = self._code(self._quantity.read(event.value))
        except BadQuantityError:
            code = ""
        self.query_one(".code", Static).update(Content(code))

    @on(Input.Submitted)
    def _submit(self, event: Input.Submitted) -> None:
        event.stop()
        self._take(event.value)

    def _take(self, text: str) -> None:
        if not text.strip():
            self.dismiss((None,))
            return
        try:
            self.dismiss((self._quantity.read(text),))
        except BadQuantityError as error:
            self.query_one("#wrong", Static).update(Content(f"{error}."))
