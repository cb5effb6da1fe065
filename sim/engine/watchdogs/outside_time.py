"""Finds a program whose threads do not return to virtual time, and names the line."""

import sys
import threading
import time
from collections.abc import Callable

from sim.clock import VirtualClock
from sim.engine.watchdogs.thread_positions import place_of
from sim.probes.own_code import outwards
from sim.trace.events import AnyEvent, EntityId, Notice, NoticeKind, Severity

_RealThread = threading.Thread
_real_sleep = time.sleep

_LOOK = 0.1
"""Real seconds between two checks."""
_PATIENCE = 15
"""Checks without a step after which the program is reported."""
_LAST_PATIENCE = 35
"""Checks without a step after which ``give_up`` is called."""
_PROBLEM = f"has not come back for {_LOOK * _PATIENCE:g} real seconds"
_PATIENCE_WITH_C_CODE = 10.0
"""Real seconds in which this thread must check again, unless C code blocks it; high for busy machines."""
_PATIENCE_WITH_IMPORTS = 150
"""The same limit for a thread that imports, as large libraries take long."""


class Watchdog:
    """Checks on a thread outside the clock whether the threads of a virtual clock still take steps."""

    def __init__(
        self,
        clock: VirtualClock,
        record: Callable[[AnyEvent], None],
        callback_on: Callable[[int], EntityId],
        give_up: Callable[[str], None],
        be_back_in: Callable[[float], None],
    ) -> None:
        """``callback_on`` returns the callback that runs on a thread, by its identifier (0: none).

        ``be_back_in`` gets the real seconds in which it must be called again, which C code may prevent.
        """
        self._clock = clock
        self._record = record
        self._callback_on = callback_on
        self._give_up = give_up
        self._be_back_in = be_back_in

    def start(self) -> None:
        """Start the checking thread."""
        _RealThread(target=self._watch, name="watchdog", daemon=True).start()

    def _watch(self) -> None:
        steps, still, sentence = self._clock.time.recesses.steps, 0, ""
        while True:
            self._be_back_in(_PATIENCE_WITH_C_CODE)
            _real_sleep(_LOOK)
            still = (
                still + 1 if self._clock.time.recesses.steps == steps and not self._clock.time.rests else 0
            )
            steps = self._clock.time.recesses.steps
            if still == _PATIENCE:
                sentence = self._sentence()
                entity = self._callback_on(self._clock.current.ident)
                kind, now = NoticeKind.NO_PROGRESS, self._clock.now()
                self._record(Notice(now, Severity.WARN, sentence, entity, kind=kind, problem=_PROBLEM))
            elif (still == _LAST_PATIENCE and not self._imports()) or (
                still == _PATIENCE_WITH_IMPORTS and self._imports()
            ):
                self._give_up(sentence)

    def _imports(self) -> bool:
        stack = outwards(sys._current_frames().get(self._clock.current.ident))
        return any(frame.f_globals.get("__name__") == "_frozen_importlib" for frame in stack)

    def _sentence(self) -> str:
        thread = self._clock.current
        return (
            f"{thread.name} does not come to a wait ({place_of(thread)}): it computes, or runs one callback "
            "after another, perhaps without end, or waits for something outside the virtual clock; mend it, "
            "or run the file by itself with --clock real"
        )
