"""A Markdown text in one widget.

Textual's own Markdown creates a widget per paragraph and bullet. A lesson's page has dozens, and each change
of focus restyles all of them, which dominated the time of changing panes.
"""

from typing import ClassVar

from rich.console import Console, ConsoleOptions, RenderResult
from rich.markdown import Heading, Markdown, MarkdownElement
from rich.theme import Theme
from textual.reactive import reactive
from textual.widget import Widget

_LOOKS = ("h1", "h2", "code", "bullet")


class Prose(Widget):
    """Shows a Markdown text, ``text``; links are not opened. Its styles are in the console's style sheet."""

    COMPONENT_CLASSES: ClassVar[set[str]] = {f"prose--{look}" for look in _LOOKS}
    DEFAULT_CSS = "Prose { height: auto; }"

    text: reactive[str] = reactive("", layout=True)

    def __init__(self, text: str, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id)
        self.set_reactive(Prose.text, text)

    def render(self) -> "_Page":
        """Return the text in the looks of the theme in force."""
        h1, h2, code, bullet = (
            self.get_component_rich_style(f"prose--{look}", partial=True) for look in _LOOKS
        )
        styles = {
            "h1": h1,
            "h2": h2,
            "code": code,
            "item.bullet": bullet,
            "item.number": bullet,
            "block_quote": bullet,
        }
        return _Page(self.text, Theme({f"markdown.{name}": style for name, style in styles.items()}))

    def letters_above(self, row: int) -> int:
        """Return how many letters and digits come before a row, which no width of the text changes."""
        return sum(self._letters_in(above) for above in range(row))

    def row_of(self, letter: int) -> int:
        """Return the row with a letter, by its place among all letters and digits."""
        row, after = 0, self._letters_in(0)
        while after <= letter and row < self.size.height - 1:
            row += 1
            after += self._letters_in(row)
        return row

    def _letters_in(self, row: int) -> int:
        return sum(map(str.isalnum, self.render_line(row).text))


class _Page:
    """A Markdown text with a theme of its own."""

    def __init__(self, text: str, theme: Theme) -> None:
        self._markdown = _Markdown(text, hyperlinks=False)
        self._theme = theme

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        with console.use_theme(self._theme):
            yield from console.render(self._markdown, options)


class _LeftHeading(Heading):
    """A heading at the left, without a frame."""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        yield self.text


class _Markdown(Markdown):
    elements: ClassVar[dict[str, type[MarkdownElement]]] = Markdown.elements | {"heading_open": _LeftHeading}
