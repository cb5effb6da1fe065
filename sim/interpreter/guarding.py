"""Tells a lock that guards something from one that is a signal, by how the source takes and releases it."""

import ast
import linecache
from functools import lru_cache
from types import FrameType


def takes_to_guard(frame: FrameType) -> bool:
    """Return whether a frame is at an ``acquire`` of a lock that only who has taken it releases.

    So it is if every function that releases the lock takes it as well; else the lock is a signal.
    """
    return frame.f_lineno in _guarding_lines(frame.f_code.co_filename)


@lru_cache(maxsize=64)
def _guarding_lines(file: str) -> frozenset[int]:
    try:
        tree = ast.parse("".join(linecache.getlines(file)))
    except (SyntaxError, ValueError):
        return frozenset()
    found: set[tuple[str, int]] = set()
    signals: set[str] = set()
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
            taken, released = _calls(function, "acquire"), _calls(function, "release")
            signals |= {_name(lock) for lock in released.keys() - taken.keys()}
            found |= {(lock, line) for lock, lines in taken.items() if lock in released for line in lines}
    return frozenset(line for lock, line in found if _name(lock) not in signals)


def _name(lock: str) -> str:
    """The last name of an expression: two objects may have one lock."""
    return lock.rpartition(".")[2]


def _calls(function: ast.AST, method: str) -> dict[str, list[int]]:
    """Return the lines of a function that call a method, by the expression of its object."""
    found: dict[str, list[int]] = {}
    for each in ast.walk(function):
        if isinstance(each, ast.Call) and isinstance(each.func, ast.Attribute) and each.func.attr == method:
            found.setdefault(ast.unparse(each.func.value), []).append(each.lineno)
    return found
