"""Finds a program whose threads never let virtual time pass, and names the line."""

import time
from collections.abc import Callable

from sim.clock import VirtualClock
from sim.clock.recesses import WAITS_TO_RECESS
from sim.engine.watchdogs.thread_positions import place_of
from sim.trace.events import AnyEvent, Notice, NoticeKind, Severity

# Kept from before sim.clock.stdlib replaces it.
_monotonic = time.monotonic

_PATIENCE = 10
"""Recesses after which the program is reported."""
_LAST_PATIENCE = 3.5
"""Real seconds from then on after which ``give_up`` is called."""


class StandstillDetector:
    """Counts the recesses of a moment; warns once per run.

    Threads that exchange data with each other always reach new waits, and may still end: they are reported
    only when the run is given up.
    """

    def __init__(
        self, clock: VirtualClock, record: Callable[[AnyEvent], None], give_up: Callable[[str], None]
    ) -> None:
        self._clock = clock
        self._record = record
        self._give_up = give_up
        self._told = False
        self._said = ""
        self._began = 0.0

    def look(self, recess: int) -> None:
        """Take a recess; the clock calls this on the waiting thread."""
        if recess == _PATIENCE:
            self._began, self._said = _monotonic(), self._sentence()
            if not self._told and self._clock.time.recesses.idles:
                self._told = True
                now, kind = self._clock.now(), NoticeKind.NO_PROGRESS
                self._record(Notice(now, Severity.WARN, self._said, kind=kind))
        elif recess > _PATIENCE and _monotonic() - self._began > _LAST_PATIENCE:
            self._give_up(self._said)

    def _sentence(self) -> str:
        thread = self._clock.current
        return (
            f"time stands still: {thread.name} ({place_of(thread)}) and whatever else runs came to more than "
            f"{_PATIENCE * WAITS_TO_RECESS:,} waits in one moment; a loop whose waits last 0 s never lets "
            "time pass: let it sleep a little, or run the file by itself with --clock real"
        )
