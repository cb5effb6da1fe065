"""Notices a program whose threads go on and on in one moment of virtual time, and names the place."""

from collections.abc import Callable

from sim.clock import VirtualClock
from sim.clock.virtual import WAITS_TO_RECESS
from sim.engine.places import place_of
from sim.trace.events import AnyEvent, Notice, Severity

_PATIENCE = 10
"""Recesses after which the person is told."""
_LAST_PATIENCE = 1_000
"""Recesses after which ``give_up`` is called."""


class Standstill:
    """Counts the recesses of a moment; the person is told once a run."""

    def __init__(
        self,
        clock: VirtualClock,
        record: Callable[[AnyEvent], None],
        give_up: Callable[[str], None],
    ) -> None:
        self._clock = clock
        self._record = record
        self._give_up = give_up
        self._told = False

    def look(self, recess: int) -> None:
        """Take note of a recess; the clock calls this on the thread that waits."""
        if recess == _PATIENCE and not self._told:
            self._told = True
            self._record(Notice(self._clock.now(), Severity.WARN, self._sentence(recess)))
        elif recess == _LAST_PATIENCE:
            self._give_up(self._sentence(recess))

    def _sentence(self, recess: int) -> str:
        thread = self._clock.current
        return (
            f"time stands still: {thread.name} ({place_of(thread)}) and whatever else runs came to "
            f"{recess * WAITS_TO_RECESS:,} waits in one moment; a loop that sleeps 0 s never lets time pass: "
            "let it sleep a little, or run the file by itself with --clock real"
        )
