"""A line on standard error that shows the progress of a command, and is removed at its end."""

import sys
import time
from contextlib import suppress
from typing import Self

_EVERY = 5.0
"""Seconds before a line, and between two, where standard error is no terminal."""


class ProgressLine:
    """Shows one line that each text overwrites; where standard error is no terminal, a new one now and then.

    Leaving the context removes it from a terminal. Not thread-safe.
    """

    def __init__(self) -> None:
        self._is_terminal = sys.stderr.isatty()
        self._due = time.monotonic() + _EVERY
        self._text = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        if self._is_terminal:
            self.show("")

    def show(self, text: str) -> None:
        """Replace the shown text, or add a line once it is due."""
        if text == self._text or not (self._is_terminal or time.monotonic() >= self._due):
            return
        self._text, self._due = text, time.monotonic() + _EVERY
        with suppress(OSError):
            sys.stderr.write(f"\r\033[K{text}" if self._is_terminal else f"{text}\n")
            sys.stderr.flush()
