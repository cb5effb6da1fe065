"""Finds who holds a lock for which a thread waits, as far as frames and source show that.

A frame inside the body of a ``with`` holds its lock. Expressions are read in the source, and resolved by
plain look-ups in frames and objects, so that no code of the program runs. Python 3.10 does not tell the
columns of an instruction: there nothing is found, nor in a file that was changed since the program began.
"""

from __future__ import annotations

import ast
import linecache
import threading
import time
from collections import defaultdict
from contextlib import suppress
from functools import lru_cache
from inspect import getattr_static
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping
    from types import CodeType, FrameType

Place = tuple[int, int, int, int]
"""First and last line, first and last column in bytes."""
UNKNOWN = (0, 0, 0, 0)
_BEGAN = time.time()
_LOCK, _RLOCK = type(threading.Lock()), type(threading.RLock())


class _Block(NamedTuple):
    """The part of a function in which a lock is held, from an instruction to another."""

    lock: ast.expr
    line: int
    """Where it is taken."""
    first: tuple[int, int]
    last: tuple[int, int]


class _Function(NamedTuple):
    """Where a function takes locks, and where it holds them."""

    takings: dict[Place, ast.expr]
    blocks: list[_Block]


class Holder(NamedTuple):
    """Who holds a lock: a thread by Python's identifier, else an entity whose callback is suspended."""

    ident: int
    entity: int
    taken_at: tuple[str, int]


class HeldLocks:
    """The locks that threads and suspended coroutines hold at one moment."""

    def __init__(
        self, tops: Mapping[int, FrameType], suspended: Mapping[Any, int], is_own: Callable[[FrameType], bool]
    ) -> None:
        self._holders: defaultdict[int, list[Holder]] = defaultdict(list)
        for ident, top in tops.items():
            self._add(ident, 0, filter(is_own, _outwards(top)), _given_up(top))
        for coroutine, entity in suspended.items():
            self._add(0, entity, filter(is_own, _suspended(coroutine)), 0)

    def _add(self, ident: int, entity: int, frames: Iterable[FrameType], given_up: int) -> None:
        for frame in frames:
            for lock, line in _held(frame):
                if id(lock) != given_up:
                    self._holders[id(lock)].append(Holder(ident, entity, (frame.f_code.co_filename, line)))

    def holder_of(self, lock: Any, waiting: int) -> Holder | None:
        """Who holds a lock for which the thread ``waiting`` waits; None if it is not known, or doubtful."""
        found = [
            each for each in self._holders[id(lock)] if type(lock) is not _RLOCK or each.ident != waiting
        ]
        return found[-1] if len({each[:2] for each in found}) == 1 else None


def wanted_lock(frame: FrameType) -> Any | None:
    """The lock that a frame takes, without a timeout, by the instruction at which it is; None for none."""
    text = linecache.getline(frame.f_code.co_filename, frame.f_lineno)
    if "with" not in text and "acquire" not in text:
        return None
    taken = _function(frame.f_code).takings.get(place_of(frame.f_code, frame.f_lasti))
    return None if taken is None else _lock_in(_value(taken, frame))


def place_of(code: CodeType, instruction: int) -> Place:
    """Where an instruction stands in the source; zeros before Python 3.11."""
    places = getattr(code, "co_positions", None)
    if places is None:
        return UNKNOWN
    first, last, start, end = next(islice(places(), instruction // 2, None), UNKNOWN)
    return first or 0, last or 0, start or 0, end or 0


def _held(frame: FrameType) -> Iterator[tuple[Any, int]]:
    """The locks in whose blocks a frame is, and where it took them; the innermost first."""
    blocks = _function(frame.f_code).blocks
    first, last, start, end = place_of(frame.f_code, frame.f_lasti) if blocks else UNKNOWN
    for block in reversed(blocks):
        if first and block.first <= (first, start) and (last, end) <= block.last:
            lock = _lock_in(_value(block.lock, frame))
            if lock is not None:
                yield lock, block.line


def _given_up(top: FrameType) -> int:
    """The id of the lock that a thread has let go of to wait for a condition; 0 for none."""
    for frame in _outwards(top):
        if frame.f_code is threading.Condition.wait.__code__:
            return id(_lock_in(frame.f_locals.get("self")))
    return 0


def _outwards(frame: FrameType | None) -> Iterator[FrameType]:
    while frame is not None:
        yield frame
        frame = frame.f_back


def _suspended(coroutine: Any) -> list[FrameType]:
    """The frames of a suspended coroutine, the innermost first."""
    frames: list[FrameType] = []
    while (frame := getattr(coroutine, "cr_frame", None)) is not None:
        frames.insert(0, frame)
        coroutine = getattr(coroutine, "cr_await", None)
    return frames


def _lock_in(value: Any) -> Any | None:
    """The lock that an object is, or that a condition has; None for others."""
    if type(value) is threading.Condition:
        value = getattr_static(value, "_lock", None)
    return value if type(value) in (_LOCK, _RLOCK) else None


def _value(expression: ast.expr, frame: FrameType) -> Any:
    if isinstance(expression, ast.Name):
        return frame.f_locals.get(expression.id, frame.f_globals.get(expression.id))
    if not isinstance(expression, ast.Attribute):
        return None
    owner, names = _value(expression.value, frame), [expression.attr]
    if names[0].startswith("__"):
        names += [f"_{each.__name__.lstrip('_')}{names[0]}" for each in type(owner).__mro__]
    values = (getattr_static(owner, name, None) for name in names)
    return next((each for each in values if each is not None), None)


def _function(code: CodeType) -> _Function:
    is_module = code.co_name == "<module>"
    key = (0 if is_module else code.co_firstlineno, code.co_name)
    return _functions(code.co_filename).get(key) or _Function({}, [])


@lru_cache(maxsize=256)
def _functions(file: str) -> dict[tuple[int, str], _Function]:
    """The functions of a file that take locks, by their first lines and names."""
    found: defaultdict[tuple[int, str], _Function] = defaultdict(lambda: _Function({}, []))
    with suppress(OSError, SyntaxError, ValueError, RecursionError):
        if Path(file).stat().st_mtime <= _BEGAN:
            _collect(ast.parse("".join(linecache.getlines(file))), (0, "<module>"), found)
    return dict(found)


def _collect(node: ast.AST, key: tuple[int, str], found: defaultdict[tuple[int, str], _Function]) -> None:
    for child in ast.iter_child_nodes(node):
        inside = key
        if isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef)):
            inside = min(each.lineno for each in (child, *child.decorator_list)), child.name
        elif isinstance(child, ast.With):
            _add_with(child, found[key])
        elif isinstance(child, ast.Call) and (lock := _named_in(child, "acquire")) is not None:
            found[key].takings[_place(child)] = lock
        _collect(child, inside, found)


def _named_in(node: ast.AST, call: str) -> ast.expr | None:
    """The object of which a node calls a method without arguments; None for other nodes."""
    if not isinstance(node, ast.Call) or node.args or node.keywords:
        return None
    function = node.func
    return function.value if isinstance(function, ast.Attribute) and function.attr == call else None


def _add_with(block: ast.With, function: _Function) -> None:
    """Add what a ``with`` takes: until Python 3.12 the instruction for that is the whole statement."""
    locks = [each.context_expr for each in block.items]
    starts = [*map(_place, locks[1:]), _place(block.body[0])]
    _, last, _, end = whole = _place(block)
    if len(locks) == 1:
        function.takings[whole] = locks[0]
    for lock, (first, _, start, _) in zip(locks, starts, strict=True):
        function.takings[_place(lock)] = lock
        if not _lets_go(block, ast.unparse(lock)):
            function.blocks.append(_Block(lock, lock.lineno, (first, start), (last, end)))


def _lets_go(block: ast.With, lock: str) -> bool:
    """Whether a ``with`` may release its lock before its end, or give the lock's name to another one."""
    released = (_named_in(each, "release") for each in ast.walk(block))
    names = (each for each in ast.walk(block) if isinstance(each, (ast.Name, ast.Attribute)))
    stored = (each for each in names if isinstance(each.ctx, ast.Store))
    return lock in {ast.unparse(each) for each in (*released, *stored) if each is not None}


def _place(node: ast.expr | ast.stmt) -> Place:
    return node.lineno, node.end_lineno or 0, node.col_offset, node.end_col_offset or 0
