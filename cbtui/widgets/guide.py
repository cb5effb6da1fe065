"""The lesson's text."""

from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.widgets import Markdown


class Guide(VerticalScroll):
    """Shows a Markdown text; links are not opened."""

    def __init__(self, text: str, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id)
        self._text = text

    def compose(self) -> ComposeResult:
        """Lay out the text."""
        yield Markdown(self._text, open_links=False)
