"""Samples the line of the program's own code at which each running callback and the main thread are."""

from __future__ import annotations

import sys
import sysconfig
import threading
from typing import TYPE_CHECKING, Any

from .callbacks import is_own
from .recorder import now

if TYPE_CHECKING:
    from types import CodeType, FrameType

    from .executors import Executors
    from .recorder import Recorder

_LIBRARIES = (
    *(sysconfig.get_path(name) for name in ("purelib", "platlib")),
    *("/usr/lib/python3/", "/opt/ros/"),
)
"""Folders of installed packages; those of a workspace are elsewhere, and count as the program's own."""
_CALLBACKS = "cbtui_probe.callbacks"
_DEEPEST = 20
"""The most lines of one stack that are reported, the innermost ones."""
_UNKNOWN = (0, 0, 0, 0)
_TIMEOUTS = ("timeout_sec", "timeout", "time_to_wait")
"""The arguments that limit a wait, in seconds; negative numbers, infinity and None do not."""
_LONGEST = 1_000_000_000
"""Seconds of the longest timeout that is reported."""
_EVERY = 250_000_000
"""Nanoseconds between two looks at the program's main thread."""


class PositionSampler:
    """Samples the threads that run callbacks, and the main thread; reports where each is if that has changed.

    The main thread is reported while nobody spins, and while it spins inside ``__init__`` or what another
    thread spins. For one thread.
    """

    def __init__(self, recorder: Recorder, executors: Executors) -> None:
        self._recorder = recorder
        self._executors = executors
        self._latest: dict[int, tuple[Any, ...]] = {}
        self._main = threading.main_thread().ident
        self._main_due = 0
        self._main_lines: list[Any] = []

    def look(self) -> None:
        """Sample once."""
        self._look_at_callbacks()
        if now() >= self._main_due:
            self._main_due = now() + _EVERY
            self._look_at_program()

    def _look_at_program(self) -> None:
        stack = _stack(sys._current_frames().get(self._main or 0), until="")
        position = _position(stack)
        if position is None or _CALLBACKS in map(_module, stack):
            return
        lines, *rest = position
        spins = any(each.is_spun() and self._main not in each.seconds for each in self._executors.all())
        if spins and all(function != "__init__" for _, function, _ in lines):
            lines = []
        if lines != self._main_lines:
            self._main_lines = lines
            self._recorder.put("at", now(), 0, 0, lines, *rest)

    def _look_at_callbacks(self) -> None:
        running = [each for spinner in self._executors.all() for each in spinner.busy.copy().items()]
        tops = sys._current_frames() if running else {}
        for thread, entity in running:
            stack = _stack(tops.get(self._recorder.idents[thread]), until=_CALLBACKS)
            instructions = entity, [(frame.f_code, frame.f_lasti) for frame in stack]
            if self._latest.get(thread) != instructions:
                self._latest[thread] = instructions
                position = _position(stack)
                if position is not None:
                    self._recorder.put("at", now(), entity, thread, *position)


def _stack(top: FrameType | None, until: str) -> list[FrameType]:
    """The frames that a module has called, the innermost first; none if it is not on the stack. "": all."""
    stack = []
    while top is not None and _module(top) != until:
        stack.append(top)
        top = top.f_back
    return stack if top is not None or not until else []


def _position(stack: list[FrameType]) -> tuple[Any, ...] | None:
    """The program's own lines, the innermost last; the instruction there, and the function that it called.

    That is followed by when the function's timeout is over, 0 for none, and whether it sleeps by simulated
    time.
    """
    own = [
        place
        for place, frame in enumerate(stack)
        if is_own(frame) and not frame.f_code.co_filename.startswith(_LIBRARIES)
    ]
    if not own:
        return None
    lines = [
        (frame.f_code.co_filename, frame.f_code.co_name, frame.f_lineno)
        for frame in (stack[place] for place in reversed(own[:_DEEPEST]))
    ]
    if own[0] == 0:
        return lines, _place(stack[0].f_code, stack[0].f_lasti), "", "", 0, False
    inside = reversed(stack[: own[0]])
    called = next((frame for frame in inside if not _module(frame).startswith("cbtui_probe")), stack[0])
    name = getattr(called.f_code, "co_qualname", called.f_code.co_name)
    is_simulated = getattr(called.f_locals.get("self"), "ros_time_is_active", False) is True
    return lines, _UNKNOWN, _module(called), name, _until(called), is_simulated


def _until(function: FrameType) -> int:
    values = function.f_locals
    seconds = next((values[name] for name in _TIMEOUTS if name in values), None)
    if isinstance(seconds, (int, float)) and 0 < seconds <= _LONGEST:
        return now() + int(seconds * 1e9)
    return 0


def _module(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__"))


def _place(code: CodeType, instruction: int) -> tuple[int, ...]:
    """First and last line, first and last column in bytes, of an instruction; zeros before Python 3.11."""
    places = getattr(code, "co_positions", None)
    if places is None:
        return _UNKNOWN
    return tuple(number or 0 for number in list(places())[instruction // 2])
