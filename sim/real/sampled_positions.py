"""What a callback does at a sampled position; read from the source, since C functions have no frame."""

import ast
import linecache
from functools import lru_cache

from sim.engine.callback_positions import LOCK, loop_around
from sim.engine.waited_lock import expressions_of_locks, lock_name, source_text
from sim.real.wire import At
from sim.trace.events import CallbackAt, Doing, ProgramAt

_WAITING = ("threading", "queue", "concurrent.futures", "multiprocessing")
"""Modules in which threads wait for each other."""
_COMPUTES = Doing.COMPUTES, ""
_FUNCTIONS = {
    "sleep": (Doing.SLEEPS, "time.sleep"),
    "acquire": (Doing.WAITS, LOCK),
    "input": (Doing.READS, "input"),
    "readline": (Doing.READS, "input"),
}
"""What those made of C do, by their names."""


def position_of(seen: At, t: int) -> CallbackAt | ProgramAt:
    """The event of the trace."""
    doing, call = _called(seen) if seen.module else _built_in(seen)
    loops = (loop_around(file, line) for file, _, line in reversed(seen.frames))
    position = doing, call, seen.frames, next(filter(None, loops), ("", 0))
    until = t + seen.until - seen.t if seen.until and doing is not Doing.SLEEPS else 0
    if seen.entity:
        lock = _lock(seen) if call == LOCK else ""
        taken = seen.keeper, lock, seen.taken_at, seen.taken_by
        return CallbackAt(t, seen.entity, seen.thread, *position, seen.holder, until, *taken)
    return ProgramAt(t, *position, until)


def _called(seen: At) -> tuple[Doing, str]:
    """What a callback does in a function of Python's library or rclpy, by its qualified name."""
    module, function = seen.module, seen.function
    if module.partition(".")[0] == "rclpy":
        is_pause = function.rpartition(".")[2].startswith("sleep") and not function.startswith("Rate.")
        if is_pause:  # simulated time comes as messages, which somebody has to take in
            return (Doing.WAITS if seen.is_simulated else Doing.SLEEPS), function
        return Doing.CALLS_ROS, function
    if not module.startswith(_WAITING):
        return _COMPUTES
    is_entered = function.rpartition(".")[2] == "__enter__"  # a condition's
    return Doing.WAITS, LOCK if is_entered else function


def _built_in(seen: At) -> tuple[Doing, str]:
    """What a callback does at an instruction of its own that has called no Python function."""
    if not seen.frames:
        return _COMPUTES
    file, _, line = seen.frames[-1]
    text = source_text(file, seen.instruction)
    try:
        does = ast.parse(f"({text})", mode="eval").body
    except (SyntaxError, ValueError):
        does = None
    if isinstance(does, ast.Call):
        return _FUNCTIONS.get(ast.unparse(does.func).rpartition(".")[2], _COMPUTES)
    is_entered = _is_with(text) if does is None else _is_entered(file, line, text)
    return (Doing.WAITS, LOCK) if is_entered else _COMPUTES


def _lock(seen: At) -> str:
    """The name of the lock for which a callback waits; "" if it takes one of several by one ``with``."""
    taken = expressions_of_locks(source_text(seen.frames[-1][0], seen.instruction))
    return lock_name(taken[0]) if len(taken) == 1 else ""


def _is_with(text: str) -> bool:
    """Whether an instruction is a whole ``with``, as that which enters it is until Python 3.12."""
    try:
        [statement] = ast.parse(text).body
    except (SyntaxError, ValueError):
        return False
    return isinstance(statement, ast.With)


@lru_cache(maxsize=256)
def _is_entered(file: str, line: int, text: str) -> bool:
    """Whether a line has a ``with`` on this expression.

    If entering it takes time and has no Python frame, it is a lock.
    """
    try:
        tree = ast.parse("".join(linecache.getlines(file)))
    except (SyntaxError, ValueError):
        return False
    entered = (
        item.context_expr for node in ast.walk(tree) if isinstance(node, ast.With) for item in node.items
    )
    return any(each.lineno == line and ast.unparse(each) == text for each in entered)
