"""Samples the line of the program's own code at which each running callback and the main thread are."""

from __future__ import annotations

import sys
import sysconfig
import threading
from concurrent.futures import Future
from concurrent.futures.thread import _WorkItem
from itertools import takewhile
from typing import TYPE_CHECKING, Any

from .callbacks import is_own
from .locks import HeldLocks, place_of, wanted_lock
from .recorder import now

if TYPE_CHECKING:
    from types import CodeType, FrameType

    from .executors import Executors
    from .locks import Holder
    from .recorder import Recorder

_LIBRARIES = (
    *(sysconfig.get_path(name) for name in ("purelib", "platlib")),
    *("/usr/lib/python3/", "/opt/ros/"),
)
"""Folders of installed packages; those of a workspace are elsewhere, and count as the program's own."""
_CALLBACKS = "cbtui_probe.callbacks"
_DEEPEST = 20
"""The most lines of one stack that are reported, the innermost ones."""
_TIMEOUTS = ("timeout_sec", "timeout", "time_to_wait")
"""The arguments that limit a wait, in seconds; negative numbers, infinity and None do not."""
_LONGEST = 1_000_000_000
"""Seconds of the longest timeout that is reported."""
_EVERY = 250_000_000
"""Nanoseconds between two looks at the program's main thread."""
_HOLDERS_EVERY = 50_000_000
"""Nanoseconds between two looks for the holders of locks."""
_Named = tuple[int, int, tuple[str, int], str]
_NOBODY: _Named = (0, 0, ("", 0), "")
_JOB, _RESULT = _WorkItem.run.__code__, Future.result.__code__


class _Sample:
    """Where a callback is on a thread."""

    def __init__(self, entity: int, stack: list[FrameType]) -> None:
        self.entity = entity
        self.instructions = _instructions(stack)
        self.position = _position(stack)
        self.more: tuple[Any, ...] = _NOBODY
        """Who holds the lock for which it waits, and where a job of a pool waits for another one."""


class PositionSampler:
    """Samples the threads that run callbacks, and the main thread; reports where each is if that has changed.

    The main thread is reported while nobody spins, and while it spins inside ``__init__`` or what another
    thread spins. For one thread.
    """

    def __init__(self, recorder: Recorder, executors: Executors) -> None:
        self._recorder = recorder
        self._executors = executors
        self._latest: dict[int, _Sample] = {}
        self._main = threading.main_thread().ident
        self._main_due = 0
        self._main_lines: list[Any] = []
        self._holders_due = 0

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
        stand: list[tuple[int, list[FrameType]]] = []
        for thread, entity in running:
            stack = _stack(tops.get(self._recorder.idents[thread]), until=_CALLBACKS)
            latest = self._latest.get(thread)
            if latest is not None and (latest.entity, latest.instructions) == (entity, _instructions(stack)):
                stand.append((thread, stack))
                continue
            latest = self._latest[thread] = _Sample(entity, stack)
            if latest.position is not None:
                self._recorder.put("at", now(), entity, thread, *latest.position)
        if now() >= self._holders_due:
            self._holders_due = now() + _HOLDERS_EVERY
            self._look_for_holders(stand, tops, dict(running))

    def _look_for_holders(
        self, stand: list[tuple[int, list[FrameType]]], tops: dict[int, FrameType], running: dict[int, int]
    ) -> None:
        """Report who holds the locks for which threads wait that ``stand`` where they stood before.

        And where a job waits for another one, if one of them waits for a job.
        """
        idents, held = self._recorder.idents, None
        threads = {idents[each]: each for each in running}
        for thread, stack in stand:
            latest, found = self._latest[thread], None
            own = next(filter(_is_written, stack), None)
            lock = None if own is None else wanted_lock(own)
            if lock is not None:
                held = held or HeldLocks(tops, self._suspended(), _is_written)
                if _instructions(stack) == latest.instructions:  # it has not gone on meanwhile
                    found = held.holder_of(lock, idents[thread])
            more: tuple[Any, ...] = _NOBODY if found is None else _named(found, threads)
            if any(frame.f_code is _RESULT for frame in stack):
                more = (*_NOBODY, _waiting_job(tops))
            if latest.position is not None and latest.more != more:
                latest.more = more
                self._recorder.put("at", now(), latest.entity, thread, *latest.position, *more)

    def _suspended(self) -> dict[Any, int]:
        known = self._recorder.suspended
        coroutines = (each() for each in known.keyrefs())  # others may come meanwhile
        return {each: known.get(each, 0) for each in coroutines if each is not None}


def _named(holder: Holder, threads: dict[int, int]) -> _Named:
    """The ids of the thread and the entity that hold a lock, where it was taken, and the thread's name."""
    thread, name = threads.get(holder.ident, 0), ""
    if not (thread or holder.entity):
        name = next((each.name for each in threading.enumerate() if each.ident == holder.ident), "")
    return thread, holder.entity, holder.taken_at, name


def _waiting_job(tops: dict[int, FrameType]) -> tuple[str, str, int]:
    """File, function and line at which a job of a pool waits for another job; "" and 0 for none."""
    for top in tops.values():
        stack = [*takewhile(lambda frame: _module(frame) != _CALLBACKS, _stack(top, until=""))]
        codes = [frame.f_code for frame in stack]
        own = next(filter(_is_written, stack), None)
        if own is not None and _JOB in codes and _RESULT in codes[: codes.index(_JOB)]:
            return own.f_code.co_filename, own.f_code.co_name, own.f_lineno
    return "", "", 0


def _instructions(stack: list[FrameType]) -> list[tuple[CodeType, int]]:
    return [(frame.f_code, frame.f_lasti) for frame in stack]


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
    own = [place for place, frame in enumerate(stack) if _is_written(frame)]
    if not own:
        return None
    place = place_of(stack[own[0]].f_code, stack[own[0]].f_lasti)
    lines = [
        (frame.f_code.co_filename, frame.f_code.co_name, frame.f_lineno)
        for frame in (stack[place] for place in reversed(own[:_DEEPEST]))
    ]
    if own[0] == 0:
        return lines, place, "", "", 0, False
    inside = reversed(stack[: own[0]])
    called = next((frame for frame in inside if not _module(frame).startswith("cbtui_probe")), stack[0])
    name = getattr(called.f_code, "co_qualname", called.f_code.co_name)
    is_simulated = getattr(called.f_locals.get("self"), "ros_time_is_active", False) is True
    return lines, place, _module(called), name, _until(called), is_simulated


def _until(function: FrameType) -> int:
    values = function.f_locals
    seconds = next((values[name] for name in _TIMEOUTS if name in values), None)
    if isinstance(seconds, (int, float)) and 0 < seconds <= _LONGEST:
        return now() + int(seconds * 1e9)
    return 0


def _is_written(frame: FrameType) -> bool:
    """Whether a frame runs the program's own code, not that of an installed package."""
    return is_own(frame) and not frame.f_code.co_filename.startswith(_LIBRARIES)


def _module(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__"))
