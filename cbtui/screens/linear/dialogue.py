"""Questions that are asked in lines, and what asks them."""

from collections.abc import Generator
from typing import Protocol, TypeAlias

Dialogue: TypeAlias = Generator[str, str, None]
"""Yields questions, and is sent the answers."""


class LineHost(Protocol):
    """What tells lines and asks for them."""

    def tell(self, sentence: str | None) -> None:
        """Tell a line; nothing for None."""

    def tell_page(self, markdown: str) -> None:
        """Tell a Markdown text."""

    def key(self, action: str) -> str:
        """Return the key in force of one of the console's actions, as it is said."""

    def ask(self, dialogue: Dialogue) -> None:
        """Begin a dialogue."""
