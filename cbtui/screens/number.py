"""Asks for a number of a run's set-up."""

from collections.abc import Callable
from typing import ClassVar

from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.content import Content
from textual.widgets import Input, Static

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.looks.theme import Charset
from cbtui.runs.setup.quantities import BadQuantityError, Quantity
from cbtui.screens.sized import SizedModal
from cbtui.widgets.key_bar import KeyBar


class NumberScreen(SizedModal[tuple[float | None]]):
    """Gives the number, with None in its place for the program's own; None if the person thinks better of it.

    ``code`` gives the line of a program for a number.
    """

    SCOPE = Scope.NUMBER
    CSS_PATH = "window.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.NUMBER)]

    def __init__(
        self, title: str, quantity: Quantity, now: float, code: Callable[[float], str], charset: Charset
    ) -> None:
        super().__init__()
        self._title = title
        self._quantity = quantity
        self._now = now
        self._code = code
        self._charset = charset

    def compose(self) -> ComposeResult:
        """Lay out the question."""
        quantity = self._quantity
        with Container(classes="window") as window:
            window.border_title = Content(self._title)
            yield Static(f"Which {quantity.name}? Give {quantity.bounds}, or nothing for the program's own.")
            yield Input(f"{self._now:g}", compact=True)
            yield Static(classes="code")
            yield Static(id="wrong")
            yield KeyBar(Scope.NUMBER, self._charset)

    def action_go(self) -> None:
        """Take what was typed."""
        self._take(self.query_one(Input).value)

    def action_close(self) -> None:
        """Leave the number as it is."""
        self.dismiss(None)

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
