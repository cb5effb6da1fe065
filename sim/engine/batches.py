"""Turns batches of events into the bytes for the pipe: encoded, and sealed if the run asks for it."""

from collections.abc import Mapping
from itertools import count

from sim.clock import RunClock, VirtualClock
from sim.engine.watchdogs.function_integrity import FunctionIntegrity
from sim.ros.middleware.contents import Contents
from sim.trace.events import AnyEvent, RunEnded, TimePassed
from sim.trace.integrity.sealing import Seal

_BATCHES_A_LOOK = 16
"""One of so many sealed batches comes with a check of the engine's functions, which takes milliseconds."""


class Batches:
    """Packs batches, and creates the heartbeat. Used with the outbox's lock held.

    ``key`` seals the trace; b"" for no seal.
    """

    def __init__(self, clock: RunClock, contents: Contents, key: bytes) -> None:
        self._clock = clock
        self._contents = contents
        self._seal = Seal(key) if key else None
        self._integrity: FunctionIntegrity | None = None
        self._sealed = count()
        self._time_told = 0

    def guard(self, parts: Mapping[str, object]) -> None:
        """Report in sealed batches from now on which functions of the engine and ``parts`` were replaced."""
        if self._seal is not None:
            self._integrity = FunctionIntegrity(parts)

    def pack(self, events: list[AnyEvent]) -> bytes:
        """Return a batch as bytes."""
        packed = self._contents.pack(events)
        if self._seal is None:
            return packed
        replaced: tuple[str, ...] = ()
        is_last = bool(events) and isinstance(events[-1], RunEnded)
        if self._integrity is not None and (is_last or next(self._sealed) % _BATCHES_A_LOOK == 0):
            replaced = self._integrity.replaced()
        return self._seal.close(packed, replaced)

    def heartbeat(self) -> list[AnyEvent]:
        """Return an event with the time if that has changed; virtual time only if it passes at a pace."""
        told, now = self._time_told, self._clock.now()
        if isinstance(self._clock, VirtualClock):
            told, now = max(told, now), self._clock.time.reached
        if now <= told:
            return []
        self._time_told = now
        return [TimePassed(now)]
