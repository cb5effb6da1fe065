"""Records where programs, and the threads that they start, are in their code outside callbacks."""

import sys
import threading
from collections.abc import Callable, Iterable
from itertools import islice
from typing import TypeAlias

from sim.clock import RunClock
from sim.engine.callback_positions import PositionFields, position_of, wait_began
from sim.probes.probe import Probe
from sim.ros.middleware.process import Process
from sim.trace.events import AnyEvent, Doing, OwnThreadAt, ProgramAt

_EVERY = 250_000_000
"""Nanoseconds of the run between two samples."""
_MOST = 16
"""The most threads that are recorded at a time."""
_LOOKED_AT = 64
"""The most threads of which one sample reads the stack."""

_Fields: TypeAlias = tuple[Doing, str, tuple[tuple[str, str, int], ...], str]


class OwnThreads:
    """Samples the programs' main threads and those that run no callback, and records changed positions.

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
        self._programs: dict[int, tuple[object, ...]] = {}
        """The frames of each program, by its number."""
        self._latest: dict[int, OwnThreadAt] = {}
        """By the identifier of the thread."""
        self._computing: set[int] = set()
        """Threads that computed at the last sample; one that has just run a callback may seem to."""

    def look(self) -> None:
        """Take a sample if one is due; one thread at a time may call this."""
        now = self._clock.now()
        if now < self._due:
            return
        before, self._due = self._due - _EVERY, now + _EVERY
        in_callbacks, programs = self._probe.running().keys(), list(self._main_threads())
        for ident, process in programs:
            top = sys._current_frames().get(ident)
            found, since = None if ident in in_callbacks else position_of(top), wait_began(top)
            if found is not None:
                self._tell_of_program(since if since > before else now, now, process, *found)
        # The engine's own main thread may be seen before its program has begun, and after its end.
        mains = {threading.main_thread().ident or 0, *(ident for ident, _ in programs)}
        self._tell_of_threads(now, self._positions(in_callbacks | mains))

    def _tell_of_program(
        self, since: int, now: int, process: Process, position: PositionFields, timeout: int
    ) -> None:
        """Record where a program is; without frames if it spins, but not in a node's constructor."""
        doing, call, frames, loop, _ = position
        if process.spinning and all(function != "__init__" for _, function, _ in frames):
            frames = ()
        if frames != self._programs.get(process.number, ()):
            self._programs[process.number] = frames
            t = since if frames else now
            until = t + timeout if timeout else 0
            self._record(ProgramAt(t, doing, call, frames, loop, until, process.number))

    def _tell_of_threads(self, now: int, found: dict[int, _Fields]) -> None:
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

    def _positions(self, others: set[int]) -> dict[int, _Fields]:
        """Return where threads are; those of which it is known already come first."""
        tops = sys._current_frames()
        computed, self._computing = self._computing, set()
        unknown = (ident for ident in tops if ident not in self._latest)
        found: dict[int, _Fields] = {}
        for ident in (*self._latest, *islice(unknown, _LOOKED_AT)):
            at = None if ident in others else position_of(tops.get(ident))
            if at is None or len(found) == _MOST:
                continue
            (doing, call, frames, _, lock), _ = at
            if doing is Doing.COMPUTES:
                self._computing.add(ident)
            if "spin" not in call and (doing is not Doing.COMPUTES or ident in computed):
                found[ident] = doing, call, frames, lock.lock
        return found
