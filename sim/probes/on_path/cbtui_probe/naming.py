"""The name of a callback on the trace, and the lines at which it is written."""

from __future__ import annotations

import functools
import inspect
from types import CodeType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


def callback_name(callback: Callable[..., Any]) -> str:
    """The name of a callback on the trace: of the function within partials and decorators."""
    inner = innermost(callback)
    return str(getattr(inner, "__name__", type(inner).__name__))


def innermost(callback: Any) -> Any:
    """The function, method, coroutine or callable object within partials and decorators."""
    return inspect.unwrap(_without_arguments(callback))


def _without_arguments(callback: Any) -> Any:
    while isinstance(callback, functools.partial):
        callback = callback.func
    return callback


def owner_of(callback: Any) -> Any:
    """The object whose method a callback or coroutine is; None for none."""
    if inspect.iscoroutine(callback):
        return None if callback.cr_frame is None else callback.cr_frame.f_locals.get("self")
    return getattr(_without_arguments(callback), "__self__", None)


def module_of(callback: Any) -> str:
    """The name of the module in which a callback or coroutine is written."""
    inner = innermost(callback)
    if inspect.iscoroutine(inner):
        return "" if inner.cr_frame is None else str(inner.cr_frame.f_globals.get("__name__", ""))
    return str(inner.__module__)


def code_of(callback: Any) -> CodeType | None:
    """The code of a callback or coroutine, within partials and decorators; None without source."""
    inner = innermost(callback)
    if inspect.iscoroutine(inner):
        return inner.cr_code
    code = getattr(inner, "__code__", None) or getattr(type(inner).__call__, "__code__", None)
    return code if isinstance(code, CodeType) else None


def written_at(callback: Callable[..., Any] | None) -> tuple[str, str, int, int]:
    """The name, file, first and last line of a callback; file and lines are empty without source."""
    if callback is None:
        return "", "", 0, 0
    name, code = callback_name(callback), code_of(callback)
    if code is None:
        return name, "", 0, 0
    lines = [line for _, _, line in code.co_lines() if line is not None]
    return name, code.co_filename, code.co_firstlineno, max(lines, default=code.co_firstlineno)
