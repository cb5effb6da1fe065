"""Records where a program is that does not reach ``spin()``, or that spins inside a node's constructor."""

import sys
import threading
from collections.abc import Callable

from sim.clock import RunClock
from sim.engine.callback_positions import position_of
from sim.probes.probe import Probe
from sim.ros.middleware.process import process_of
from sim.trace.events import AnyEvent, ProgramAt

_EVERY = 250_000_000
"""Nanoseconds of the run between two samples."""


class ProgramPosition:
    """Samples the main thread of a run's only program, and records its position if that has changed.

    A run of several programs is not sampled: each has threads of its own.
    """

    def __init__(self, probe: Probe, clock: RunClock, record: Callable[[AnyEvent], None]) -> None:
        self._probe = probe
        self._clock = clock
        self._record = record
        self._due = 0
        self._main = threading.main_thread()
        self._latest: tuple[object, ...] = ()

    def look(self) -> None:
        """Take a sample if one is due; one thread at a time may call this."""
        now = self._clock.now()
        if now < self._due:
            return
        self._due = now + _EVERY
        found = self._position()
        if found is not None and found.frames != self._latest:
            self._latest = found.frames
            self._record(found)

    def _position(self) -> ProgramAt | None:
        """Return where the program is; without frames if it spins, None if it is unknown."""
        ident = self._main.ident
        if ident is None or ident in self._probe.running():
            return None
        found = position_of(sys._current_frames().get(ident))
        if found is None:
            return None
        (doing, call, frames, loop, *_), timeout = found
        in_constructor = any(function == "__init__" for _, function, _ in frames)
        if process_of(self._main).spinning and not in_constructor:
            frames = ()
        now = self._clock.now()
        return ProgramAt(now, doing, call, frames, loop, now + timeout if timeout else 0)
