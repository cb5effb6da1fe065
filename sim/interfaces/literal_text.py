"""Parses the constants and default values of a definition, as rosidl_adapter does."""

import re
from typing import Final

from sim.interfaces.field_types import INTEGER_LIMITS

_TRUTHS: Final = {"true": True, "1": True, "false": False, "0": False}

_ITEM = re.compile(r"""\s*("(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*'|[^,]*?)\s*(?:,|$)""")
"""One item of a list, with or without quotes, and the comma after it."""


def literal_of(text: str, base: str, *, is_list: bool) -> object:
    """Return the value of a literal of a primitive type, or (``is_list``) a list of such values.

    Raises:
        ValueError: the text is not a literal of this type.
    """
    if not is_list:
        return _scalar(text, base)
    if not (text.startswith("[") and text.endswith("]")):
        raise ValueError("several values are written as [value, …]")
    return [_scalar(item, base) for item in _items(text[1:-1].strip())]


def _items(text: str) -> list[str]:
    items, at = [], 0
    while at < len(text):
        found = _ITEM.match(text, at)
        if found is None or (not found[1] and found.end() != len(text)):
            raise ValueError("its values are not parted by single commas")
        items.append(found[1])
        at = found.end()
    return items


def _scalar(text: str, base: str) -> object:
    if base in ("string", "wstring"):
        return _unquoted(text)
    if base == "bool":
        if text.lower() not in _TRUTHS:
            raise ValueError("a bool is true or false")
        return _TRUTHS[text.lower()]
    if base in ("float32", "float64"):
        return _float(text)
    return _integer(text, base)


def _unquoted(text: str) -> str:
    for quote in ("'", '"'):
        if len(text) >= 2 and text.startswith(quote) and text.endswith(quote):
            inside = text[1:-1]
            if re.search(rf"(?<!\\){quote}", inside):
                raise ValueError(f"a {quote} inside the quotes must be written as \\{quote}")
            return inside.replace(f"\\{quote}", quote)
    return text


def _float(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ValueError("it is not a number") from None


def _integer(text: str, base: str) -> int:
    try:
        value = int(text, 10) if text.lstrip("+-").isdecimal() else int(text, 0)
    except ValueError:
        raise ValueError("it is not an integer") from None
    low, high = INTEGER_LIMITS["uint8" if base in ("byte", "char") else base]
    if not low <= value <= high:
        raise ValueError(f"{base} takes integers from {low} to {high}")
    return value
