"""Quotes a word for a shell."""

from __future__ import annotations

import re

_PLAIN = re.compile(r"[\w@%+=:,./~-]+", re.ASCII)
_TO_ESCAPE = re.compile(r"[^\w@%+=:,./~-]", re.ASCII)
_TO_ESCAPE_IN_DOUBLE_QUOTES = re.compile(r'[$`"\\]')


def quoted(text: str) -> str:
    """Return a word with backslashes, as a shell completes it; text of several lines in double quotes.

    The line end after a single line is removed.
    """
    line = text.removesuffix("\n")
    if "\n" in line:
        return double_quoted(text)
    if _PLAIN.fullmatch(line):
        return line
    return _TO_ESCAPE.sub(_backslashed, line) if line else "''"


def double_quoted(text: str) -> str:
    """Return a word in double quotes."""
    return f'"{_TO_ESCAPE_IN_DOUBLE_QUOTES.sub(_backslashed, text)}"'


def _backslashed(found: re.Match[str]) -> str:
    return f"\\{found[0]}"
