"""The window that asks for a value of a run's set-up."""

from collections.abc import Callable
from typing import Generic

from textual import on
from textual.app import ComposeResult
from textual.content import Content
from textual.widgets import Input, Static

from cbtui.keys.action import Scope
from cbtui.looks.theme import Charset
from cbtui.runs.setup.quantities import TypedValue, Value
from cbtui.screens.windows.typed_line import LineScreen, TypedLine


class ValueScreen(LineScreen[tuple[Value | None]], Generic[Value]):
    """Its result is a tuple with the value, or with None for the program's own; None if it was closed.

    ``now`` is the text to begin with; ``code`` returns the line of a program for a value.
    """

    SCOPE = Scope.VALUE

    def __init__(
        self, title: str, kind: TypedValue[Value], now: str, code: Callable[[Value], str], charset: Charset
    ) -> None:
        super().__init__(charset)
        self.heading = Content(title)
        self._kind = kind
        self._now = now
        self._code = code

    def content(self) -> ComposeResult:
        """Lay out the question."""
        yield Static(f"Which {self._kind.name}? Give {self._kind.bounds}, or nothing for the program's own.")
        line = TypedLine(self._now, self._take)
        yield line
        yield Static(classes="code")
        yield line.refusal

    @on(Input.Changed)
    def _show_code(self, event: Input.Changed) -> None:
        self.query_one(TypedLine).refusal.update("")
        try:
            code = self._code(self._kind.read(event.value))
        except ValueError:
            code = ""
        self.query_one(".code", Static).update(Content(code))

    def _take(self, text: str) -> None:
        self.dismiss((self._kind.read(text) if text.strip() else None,))
