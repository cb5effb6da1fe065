"""The name of a callback on the trace, and the lines at which it is written."""

from __future__ import annotations

import functools
import inspect
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


def callback_name(callback: Callable[..., Any]) -> str:
    """The name of a callback on the trace: of the function within partials and decorators."""
    inner = _innermost(callback)
    return str(getattr(inner, "__name__", type(inner).__name__))


def _innermost(callback: Any) -> Any:
    while isinstance(callback, functools.partial):
        callback = callback.func
    return inspect.unwrap(callback)


def written_at(callback: Callable[..., Any] | None) -> tuple[str, str, int, int]:
    """The name, file, first and last line of a callback; file and lines are empty without source."""
    if callback is None:
        return "", "", 0, 0
    inner, name = _innermost(callback), callback_name(callback)
    code = getattr(inner, "__code__", None) or getattr(type(inner).__call__, "__code__", None)
    if code is None:
        return name, "", 0, 0
    lines = [line for _, _, line in code.co_lines() if line is not None]
    return name, code.co_filename, code.co_firstlineno, max(lines, default=code.co_firstlineno)
