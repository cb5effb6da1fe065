"""Records where programs are that do not reach ``spin()``, or that spin inside a node's constructor."""

import sys
from collections.abc import Callable, Iterable

from sim.clock import RunClock
from sim.engine.callback_positions import position_of
from sim.probes.probe import Probe
from sim.ros.middleware.process import Process
from sim.trace.events import AnyEvent, ProgramAt

_EVERY = 250_000_000
"""Nanoseconds of the run between two samples."""


class ProgramPosition:
    """Samples the main thread of each program, and records its position if that has changed.

    ``programs`` returns the running programs, each with the identifier of its main thread.
    """

    def __init__(
        self,
        probe: Probe,
        clock: RunClock,
        record: Callable[[AnyEvent], None],
        programs: Callable[[], Iterable[tuple[int, Process]]],
    ) -> None:
        self._probe = probe
        self._clock = clock
        self._record = record
        self._programs = programs
        self._due = 0
        self._latest: dict[int, tuple[object, ...]] = {}

    def look(self) -> None:
        """Take a sample if one is due; one thread at a time may call this."""
        now = self._clock.now()
        if now < self._due:
            return
        self._due = now + _EVERY
        for ident, process in self._programs():
            found = self._position(ident, process)
            if found is not None and found.frames != self._latest.get(process.number, ()):
                self._latest[process.number] = found.frames
                self._record(found)

    def _position(self, ident: int, process: Process) -> ProgramAt | None:
        """Return where a program is; without frames if it spins, None if it is unknown."""
        if ident in self._probe.running():
            return None
        found = position_of(sys._current_frames().get(ident))
        if found is None:
            return None
        (doing, call, frames, loop, *_), timeout = found
        in_constructor = any(function == "__init__" for _, function, _ in frames)
        if process.spinning and not in_constructor:
            frames = ()
        now = self._clock.now()
        return ProgramAt(now, doing, call, frames, loop, now + timeout if timeout else 0, process.number)
