"""Warns once in a run on virtual time that a program's action cannot be repeated exactly."""

from collections.abc import Callable

from sim.clock import RunClock
from sim.probes.own_code import place_of_caller
from sim.trace.events import AnyEvent, Notice, Severity


class Repeatability:
    """Keeps whether a run can be repeated exactly. ``record`` takes events."""

    def __init__(self, clock: RunClock, record: Callable[[AnyEvent], None]) -> None:
        self._clock = clock
        self._record = record
        self._lost = False

    def lose(self, what: str) -> None:
        """Note that the calling thread's program cannot be repeated exactly; ``what`` is the reason."""
        place = place_of_caller()
        if place and not self._lost:
            self._lost = True
            text = f"{place}: {what}, so no other run will be exactly like this one"
            self._record(Notice(self._clock.now(), Severity.WARN, text, unrepeatable=True))
