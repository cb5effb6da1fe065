"""Finds lines of the program's own that neither a stack nor a traceback shows."""

from __future__ import annotations

import inspect
import linecache
import re
from contextlib import suppress
from itertools import takewhile
from pathlib import Path
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import FrameType

    IsOwn = Callable[[FrameType], bool]
    """Whether a frame runs the program's own code."""

_PARAMETERS = {"subscription": ["message"], "service": ["request", "response"], "client": ["future"]}
_KINDS = {0: "timer", 2: "service"}
"""The kinds of callbacks by the number of their arguments; rclpy's frames show no other sign of them."""


def awaiting_frames(coroutine: Any, is_own: IsOwn) -> tuple[tuple[str, str, int], ...]:
    """The own lines at which a suspended coroutine awaits, each behind its file and function."""
    found = []
    while (frame := getattr(coroutine, "cr_frame", None)) is not None:
        if is_own(frame):
            found.append((frame.f_code.co_filename, frame.f_code.co_name, frame.f_lineno))
        coroutine = getattr(coroutine, "cr_await", None)
    return tuple(found)


def raised_at(error: BaseException, is_own: IsOwn) -> tuple[str, int]:
    """The file and line of the innermost own frame of an exception, else of its outermost frame."""
    place = ("", 0)
    for frame, line in walk_tb(error.__traceback__):
        if is_own(frame) or not place[0]:
            place = (frame.f_code.co_filename, line)
    return place


def culprit_of(error: BaseException, is_own: IsOwn) -> tuple[str, int, str] | None:
    """File and line of the definition that made rclpy raise an exception, and advice; None for another cause.

    That is a callback with wrong parameters, what hides a name of ``Node`` that rclpy uses, or an await of
    what is no future of rclpy.
    """
    frames = list(walk_tb(error.__traceback__))
    if not frames or not isinstance(error, (TypeError, AttributeError, RuntimeError, ValueError)):
        return None
    own = [(frame.f_code.co_filename, line) for frame, line in frames if is_own(frame)]
    if str(error) == "invalid method signature":  # of inspect, on a method without self
        handed_over = (each for each, _ in reversed(frames) if "callback" in each.f_locals)
        unfit = (_unfit(each.f_locals["callback"], "subscription", own[-1:]) for each in handed_over)
        return next(unfit, None)
    if is_own(frames[-1][0]):
        return _hiding_attribute(error, *frames[-1])
    if str(error).startswith("Expected coroutine to yield"):
        task = frames[-1][0].f_locals.get("self")
        awaiting = awaiting_frames(getattr(task, "_handler", None), is_own)
        return (awaiting[-1][0], awaiting[-1][2], "") if awaiting else None
    return _rejected_callback(error, frames[-1][0], own[-1:]) or _hiding(frames, is_own)


def _rejected_callback(
    error: BaseException, frame: FrameType, raised: list[tuple[str, int]]
) -> tuple[str, int, str] | None:
    text = str(error)
    if "add_entity()" in text or not any(each in text for each in ("positional argument", "callback should")):
        return None
    inside = frame.f_locals
    caller = inside.get("self")
    callback: Any = inside.get("callback", getattr(caller, "callback", None))
    given = inside.get("args")
    number = len(given) if isinstance(given, tuple) else 1
    kind = getattr(caller, "kind", _KINDS.get(number, "subscription"))
    if callback is None and _calls_with_future(caller):
        callback, kind = getattr(caller, "_handler", None), "client"
    return _unfit(callback, kind, raised)


def _unfit(callback: Any, kind: str, raised: list[tuple[str, int]]) -> tuple[str, int, str] | None:
    """File and line of a callback that takes other arguments than one of its kind, and how to define it.

    That names the line, too, at which the exception was ``raised``, if it is one of the program's own.
    """
    callback = inspect.unwrap(callback)
    code = getattr(callback, "__code__", None)
    if code is None:
        return None
    taken = [*(["self"] if inspect.ismethod(callback) else []), *_PARAMETERS.get(kind, [])]
    written = (
        f"lambda {', '.join(taken)}: …".replace(" :", ":")
        if code.co_name == "<lambda>"
        else f"def {code.co_name}({', '.join(taken)})"
    )
    at = "".join(f"{Path(file).name}:{line} raised it: " for file, line in raised)
    named = "the lambda" if code.co_name == "<lambda>" else code.co_name
    return (
        code.co_filename,
        code.co_firstlineno,
        f"{at}rclpy calls {named} with other arguments; in line {code.co_firstlineno} write {written}",
    )


def _calls_with_future(task: object) -> bool:
    """Whether a task of an executor, the model's or rclpy's, runs a done-callback of a future."""
    return any(hasattr(each, "add_done_callback") for each in getattr(task, "_args", None) or ())


def _hiding(frames: list[tuple[FrameType, int]], is_own: IsOwn) -> tuple[str, int, str] | None:
    for frame, line in takewhile(lambda each: not is_own(each[0]), reversed(frames)):
        for _, base, owners, name in _used(frame, line):
            for owner in owners:
                file, number = _written_at(owner, name) if name in vars(owner) else ("", 0)
                if file:
                    return file, number, _HIDES.format(owner.__name__, name, base.__name__)
    return None


def _hiding_attribute(error: BaseException, frame: FrameType, line: int) -> tuple[str, int, str] | None:
    """What hides a method of ``Node`` that the program itself calls: an attribute of the node."""
    if "object is not callable" not in str(error):
        return None
    for node, base, owners, name in _used(frame, line):
        for owner in owners if name in vars(node) and callable(getattr(base, name)) else ():
            file, number = _written_at(owner, name)
            if file:
                return file, number, _HIDES.format(owner.__name__, name, base.__name__)
    return None


def _used(frame: FrameType, line: int) -> Iterator[tuple[Any, type, tuple[type, ...], str]]:
    """The nodes at hand at a line, with ``Node``, the own classes made of it, and a name of its there.

    Every class may have an ``__init__`` and the like of its own.
    """
    used = re.findall(r"\.(?!__)(\w+)", linecache.getline(frame.f_code.co_filename, line))
    for node in frame.f_locals.values():
        classes = type(node).__mro__
        base = next((each for each in classes if (each.__module__, each.__name__) == _NODE), None)
        for name in used if base else ():
            if base and hasattr(base, name):
                yield node, base, classes[: classes.index(base)], name


_NODE = ("rclpy.node", "Node")
_HIDES = "{0}.{1} hides {2}.{1}, which every node has; give it another name, such as my_{1}"


def _written_at(owner: type, name: str) -> tuple[str, int]:
    """File and line of an attribute of a class; "" if they are not known."""
    value = vars(owner).get(name)
    code = getattr(getattr(value, "fget", value), "__code__", None)
    if code is not None:
        return code.co_filename, code.co_firstlineno
    with suppress(OSError, TypeError):
        lines, first = inspect.getsourcelines(owner)
        file = inspect.getsourcefile(owner) or ""
        for number, line in enumerate(lines, first):
            if re.match(rf"\s+(?:self\.)?{name}\s*[:=](?!=)", line):
                return file, number
    return "", 0
