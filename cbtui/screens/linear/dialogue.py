"""Questions that are asked in lines, and the interface of consoles that ask them."""

from collections.abc import Generator
from typing import Protocol, TypeAlias

Dialogue: TypeAlias = Generator[str, str, None]
"""Yields questions, and is sent the answers."""


class LineHost(Protocol):
    """A console that prints lines and asks for them."""

    def tell(self, sentence: str | None) -> None:
        """Print a line; nothing for None."""

    def tell_page(self, markdown: str) -> None:
        """Print a Markdown text."""

    def key(self, action: str) -> str:
        """Return the key in force of one of the console's actions in words."""

    def ask(self, dialogue: Dialogue) -> None:
        """Begin a dialogue."""
