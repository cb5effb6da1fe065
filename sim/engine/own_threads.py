"""Records where threads wait or sleep that programs start themselves."""

import sys
import threading
from collections.abc import Callable, Iterable
from itertools import islice
from typing import TypeAlias

from sim.clock import RunClock
from sim.engine.callback_positions import position_of
from sim.probes.probe import Probe
from sim.ros.middleware.process import Process
from sim.trace.events import AnyEvent, Doing, OwnThreadAt

_EVERY = 250_000_000
"""Nanoseconds of the run between two samples."""
_MOST = 16
"""The most threads that are recorded at a time."""
_LOOKED_AT = 64
"""The most threads of which one sample reads the stack."""


_Fields: TypeAlias = tuple[Doing, str, tuple[tuple[str, str, int], ...], str]


class OwnThreads:
    """Samples threads that run no callback, and records where they wait if that has changed.

    ``main_threads`` returns the running programs, each with the identifier of its main thread.
    """

    def __init__(
        self,
        probe: Probe,
        clock: RunClock,
        record: Callable[[AnyEvent], None],
        main_threads: Callable[[], Iterable[tuple[int, Process]]],
    ) -> None:
        self._probe = probe
        self._clock = clock
        self._record = record
        self._main_threads = main_threads
        self._due = 0
        self._latest: dict[int, OwnThreadAt] = {}
        """By the identifier of the thread."""

    def look(self) -> None:
        """Take a sample if one is due; one thread at a time may call this."""
        now = self._clock.now()
        if now < self._due:
            return
        self._due = now + _EVERY
        found = self._positions()
        for ident in [each for each in self._latest if each not in found]:
            gone = self._latest.pop(ident)
            self._record(OwnThreadAt(now, gone.number, gone.name, Doing.COMPUTES, "", ()))
        names = {each.ident: each.name for each in threading.enumerate()} if found else {}
        for ident, fields in found.items():
            before = self._latest.get(ident)
            if before is None or fields != (before.doing, before.call, before.frames, before.lock):
                number = self._free_number() if before is None else before.number
                self._latest[ident] = at = OwnThreadAt(now, number, names.get(ident, "a thread"), *fields)
                self._record(at)

    def _free_number(self) -> int:
        taken = {each.number for each in self._latest.values()}
        return next(number for number in range(_MOST) if number not in taken)

    def _positions(self) -> dict[int, _Fields]:
        """Return where threads wait; those of which it is known already come first."""
        tops = sys._current_frames()
        others = self._probe.running().keys() | {ident for ident, _ in self._main_threads()}
        unknown = (ident for ident in tops if ident not in self._latest)
        found: dict[int, _Fields] = {}
        for ident in (*self._latest, *islice(unknown, _LOOKED_AT)):
            at = None if ident in others else position_of(tops.get(ident))
            if at is not None and len(found) < _MOST:
                (doing, call, frames, _, lock), _ = at
                if doing is not Doing.COMPUTES and "spin" not in call:
                    found[ident] = doing, call, frames, lock.lock
        return found
