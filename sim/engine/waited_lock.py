"""The lock for which a thread waits: how the program calls it, who took it, and where.

All of it is read from frames and source; no code of the program runs for it.
"""

import ast
import linecache
import sys
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from inspect import getattr_static
from itertools import islice
from types import CodeType, FrameType, FunctionType
from typing import Any, NamedTuple

from sim.probes.own_code import outwards
from sim.probes.probe import RunningCallback
from sim.trace.events import EntityId, ThreadId
from sim.trace.events.fields import SourcePlace

_LONGEST = 40
"""Characters of the longest expression that counts as a name."""


class WaitedLock(NamedTuple):
    """A lock for which a thread waits; the fields are those of ``callback_at``."""

    holder: ThreadId = 0
    keeper: EntityId = 0
    lock: str = ""
    taken_at: SourcePlace = ("", 0)
    taken_by: str = ""
    is_left: bool = False


def waited_lock(
    own: FrameType, inside: Sequence[FrameType], running: Mapping[int, RunningCallback]
) -> WaitedLock:
    """Return the lock for which a thread waits in frames that the program's frame ``own`` has called.

    A callback that took it counts as its keeper if its call does not run any more on the thread that took it.
    """
    name = name_at(own, [each.f_locals.get("self") for each in inside])
    lock = taken_lock(inside)
    if lock is None:
        return WaitedLock(lock=name)
    now, then = running.get(lock.holder_ident), lock.taken_during
    keeper = then[0] if isinstance(then, tuple) and then != now else 0
    thread = None if now or keeper else lock.taken_by
    file, _, line = taking(lock, own)
    by, is_left = ("", False) if thread is None else (thread.name, not thread.is_alive())
    return WaitedLock(0 if now is None else now.thread, keeper, name, (file, line), by, is_left)


def taken_lock(inside: Iterable[FrameType]) -> Any | None:
    """Return the lock that frames of the library wait for, innermost first; None if its holder is unknown."""
    objects = (each.f_locals.get("self") for each in inside)
    return next((each for each in objects if getattr(each, "holder_ident", 0)), None)


def taking(lock: Any, waiting: FrameType | None) -> tuple[str, str, int]:
    """Return file, function and line at which a lock was taken last; ``waiting`` waits for it."""
    if lock.taken_at is None:
        return "", "", 0
    code, offset = lock.taken_at
    stack = outwards(sys._current_frames().get(lock.holder_ident))
    for frame in stack:
        if frame.f_code is code and frame is not waiting and (function := decorated(frame)) is not None:
            return first_line(function)
    lines = (line for start, end, line in code.co_lines() if start <= offset < end and line is not None)
    return code.co_filename, code.co_name, next(lines, code.co_firstlineno)


def decorated(frame: FrameType) -> FunctionType | None:
    """Return the function in whose place a frame runs what a decorator returned; None for other frames."""
    code, values = frame.f_code, frame.f_locals
    inner = [values.get(name) for name in code.co_freevars]
    functions = [each for each in inner if isinstance(each, FunctionType)]
    if not functions:
        return None
    arguments = values.get(code.co_varnames[0]) if code.co_varnames else None  # it may not be set yet
    owner = arguments[0] if isinstance(arguments, tuple) and arguments else arguments
    for function in functions:
        name = function.__name__
        for found in (getattr_static(owner, name, None), function.__globals__.get(name)):
            if any(each.__code__ is code for each in _wrapped(found)):
                return function
    return None


def first_line(function: FunctionType) -> tuple[str, str, int]:
    """Return file, name and first line of a function, which is that of its first decorator."""
    code = function.__code__
    return code.co_filename, code.co_name, code.co_firstlineno


def _wrapped(found: object) -> list[FunctionType]:
    """Return a function, the one that it wraps, and so on."""
    chain: list[FunctionType] = []
    while isinstance(found, FunctionType) and found not in chain:
        chain.append(found)
        found = found.__dict__.get("__wrapped__")
    return chain


def name_at(own: FrameType, objects: Sequence[object]) -> str:
    """Return the expression by which a frame takes one of some objects; "" if it is not known."""
    expressions = _expressions(own.f_code, own.f_lasti)
    if len(expressions) > 1:  # Python 3.11 tells the whole statement of several
        known = [each for each in objects if each is not None]
        values = ((each, _value(each, own)) for each in expressions)
        expressions = [each for each, value in values if any(value is one for one in known)]
    return lock_name(expressions[0]) if len(expressions) == 1 else ""


@lru_cache(maxsize=256)
def _expressions(code: CodeType, offset: int) -> list[ast.expr]:
    first, last, start, end = next(islice(code.co_positions(), offset // 2, None), (None,) * 4)
    if first is None or last is None or start is None or end is None:
        return []
    return expressions_of_locks(source_text(code.co_filename, (first, last, start, end)))


def _value(expression: ast.expr, frame: FrameType) -> object:
    match expression:
        case ast.Name(id=name):
            return frame.f_locals.get(name, frame.f_globals.get(name))
        case ast.Attribute(value=inner, attr=name):
            return getattr_static(_value(inner, frame), name, None)
    return None


def source_text(file: str, place: tuple[int, int, int, int]) -> str:
    """Return the text between two lines (from 1) and two columns of bytes; "" if it is not known."""
    first, last, start, end = place
    lines = [line.encode() for line in linecache.getlines(file)[first - 1 : last]] if first else []
    if not lines:
        return ""
    lines[-1] = lines[-1][:end]
    lines[0] = lines[0][start:]
    return b"".join(lines).decode(errors="replace")


def expressions_of_locks(text: str) -> list[ast.expr]:
    """Return the expressions of the locks that an instruction's text takes, by ``with`` or ``acquire``."""
    try:
        [statement] = ast.parse(text).body
    except (SyntaxError, ValueError):
        return []
    match statement:
        case ast.With(items=items):
            return [each.context_expr for each in items]
        case ast.Expr(value=ast.Call(func=ast.Attribute(value=lock, attr="acquire"))):
            return [lock]
        case ast.Expr(value=lock):
            return [lock]
    return []


def lock_name(expression: ast.expr) -> str:
    """Return the text of an expression that is the name of a lock, such as ``self.lock``; "" for others."""
    text = ast.unparse(expression)
    is_name = isinstance(expression, ast.Name | ast.Attribute | ast.Subscript)
    return text if is_name and len(text) <= _LONGEST else ""
