"""Reads untrusted TOML, in time and memory that grow with the text only."""

import re
import tomllib
from typing import Any

_DEEPEST = 32
"""Limit for the parts of a key, and for tables and lists inside each other."""
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+"""
_LONG_KEY = re.compile(rf"(?<![\w-]){_PART}(?:\.[ \t]*+{_PART}){{{_DEEPEST}}}")
"""For each part of a key ``tomllib`` keeps all parts before it: a key of 100 kB would take 10 GB."""


class DeepTomlError(tomllib.TOMLDecodeError):
    """A document is nested too deeply."""

    def __init__(self, text: str) -> None:
        # TOMLDecodeError asks for the document and a position from Python 3.14 on; not every fault has one.
        ValueError.__init__(self, text)


def load(text: str) -> dict[str, Any]:
    """Parse a TOML document.

    Raises:
        tomllib.TOMLDecodeError: the text is not TOML, or is nested too deeply (`DeepTomlError`).
        ValueError: a number in it has more digits than Python reads.
    """
    if found := _LONG_KEY.search(text):
        line = text.count("\n", 0, found.start()) + 1
        raise DeepTomlError(f"A key has more than {_DEEPEST} parts (at line {line}, column 1)")
    try:
        document = tomllib.loads(text)
    except RecursionError:
        document = None
    if document is None or _is_deep(document):
        raise DeepTomlError("It is nested too deeply")
    return document


def _is_deep(document: dict[str, Any]) -> bool:
    layer: list[Any] = [document]
    for _ in range(_DEEPEST):
        layer = [inner for outer in layer for inner in _inside(outer)]
    return bool(layer)


def _inside(outer: Any) -> list[Any]:
    if isinstance(outer, dict):
        return list(outer.values())
    return outer if isinstance(outer, list) else []
