"""Lets threads switch before each line of the program that uses data which threads may share."""

import ast
import linecache
import sys
import threading
from collections.abc import Hashable, Mapping
from types import CodeType, FrameType
from typing import Any

from sim.clock import VirtualClock
from sim.engine.exploration.conflicts import Conflicts
from sim.engine.exploration.shared_data import SharedData, shared_data
from sim.engine.exploration.split_lines import split_lines
from sim.engine.programs import source
from sim.interpreter.function_marks import calls_the_program
from sim.probes.own_code import is_library, is_own, outwards


class LineSwitches:
    """Traces the program's own code on every thread of the clock.

    A line is atomic: CPython switches threads inside it only where it calls something that has lines of its
    own. The lines of ``SharedData.split`` in the program's own file are exceptions, with two steps each.
    """

    def __init__(self, clock: VirtualClock, conflicts: Conflicts) -> None:
        self._clock = clock
        self._conflicts = conflicts
        self._files: dict[str, SharedData] = {}
        self._written: set[str] = set()
        self._own: dict[CodeType, SharedData | None] = {}

    def start(self) -> None:
        """Trace the calling thread and each new one, and split lines of code that is compiled from now on."""
        source.changes.append(self._split)
        threading.settrace(self._called)
        sys.settrace(self._called)

    def _called(self, frame: FrameType, _event: str, _argument: object) -> Any:
        code = frame.f_code
        if code not in self._own:
            own = is_own(frame) and not is_library(frame)
            self._own[code] = self._shared_data(code.co_filename) if own else None
        data = self._own[code]
        # A resumed coroutine keeps the trace of its frame.
        return None if data is None else frame.f_trace or self._trace_of(data)

    def _trace_of(self, data: SharedData) -> Any:
        """Return the trace function of one call of a function."""

        def take(frame: FrameType, event: str, _argument: object) -> Any:
            if event == "line":
                self._come_to_line(frame, data)
            return take

        return take

    def _shared_data(self, file: str) -> SharedData:
        if file not in self._files:
            found = self._files[file] = shared_data("".join(linecache.getlines(file)))
            self._written |= found.written
            found.split.clear()  # an imported module was not compiled here
        return self._files[file]

    def _split(self, tree: ast.Module, text: str, file: str) -> ast.Module:
        found = self._files[file] = shared_data(text)
        self._written |= found.written
        return split_lines(tree, found, self._come_to_write)

    def _come_to_write(self, value: object, name: str) -> object:
        """Let other threads go first inside a split line."""
        self._come_to(sys._getframe(1), {name: True})
        return value

    def _come_to_line(self, frame: FrameType, data: SharedData) -> None:
        """Let other threads go first if the line uses shared data, and note its accesses."""
        later = data.split.get(frame.f_lineno)
        found = data.lines.get(frame.f_lineno, {})
        self._come_to(frame, {name: writes and name != later for name, writes in found.items()})

    def _come_to(self, frame: FrameType, touched: Mapping[str, bool]) -> None:
        accesses: dict[Hashable, bool] = {
            name: writes for name, writes in touched.items() if name in self._written
        }
        if not accesses:
            return
        self._clock.switch_point(accesses)
        if self._clock.owns_current_thread():
            unit, owner = _outermost(frame), id(frame.f_locals.get("self"))
            for name, writes in accesses.items():
                self._conflicts.take((name, owner), unit, frame.f_code.co_filename, frame.f_lineno, writes)


def _outermost(frame: FrameType) -> Hashable:
    """Return the key of the callback's current call, or of the program's outermost call outside callbacks."""
    trace = frame.f_trace
    for each in outwards(frame):
        if each in calls_the_program:
            break
        trace = each.f_trace or trace
    return trace
