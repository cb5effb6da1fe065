"""Under which name a callback is on the trace, and where it is written."""

import inspect
from collections.abc import Callable
from functools import partial
from typing import Any


def callback_name(callback: Callable[..., Any]) -> str:
    """The name under which a callback is on the trace."""
    inner = _innermost(callback)
    return str(getattr(inner, "__name__", type(inner).__name__))


def _innermost(callback: Callable[..., Any]) -> Callable[..., Any]:
    while isinstance(callback, partial):
        callback = callback.func
    unwrapped: Callable[..., Any] = inspect.unwrap(callback)
    return unwrapped


def written_at(callback: Callable[..., Any] | None) -> tuple[str, str, int, int]:
    """Name, file and first and last line of a callback; empty for one without source of its own."""
    if callback is None:
        return "", "", 0, 0
    inner = _innermost(callback)
    name = callback_name(callback)
    code = getattr(inner, "__code__", None) or getattr(type(inner).__call__, "__code__", None)
    if code is None:
        return name, "", 0, 0
    lines = [line for _, _, line in code.co_lines() if line is not None]
    return name, code.co_filename, code.co_firstlineno, max(lines, default=code.co_firstlineno)
