"""A line on standard error that shows the progress of a command, and is removed at its end."""

import sys
from contextlib import suppress
from typing import Self


class ProgressLine:
    """Shows one line that each text overwrites; shows nothing if standard error is no terminal.

    Leaving the context removes it. Not thread-safe.
    """

    def __init__(self) -> None:
        self._is_seen = sys.stderr.isatty()
        self._text = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.show("")

    def show(self, text: str) -> None:
        """Replace the shown text."""
        if self._is_seen and text != self._text:
            self._text = text
            with suppress(OSError):
                sys.stderr.write(f"\r\033[K{text}")
                sys.stderr.flush()
