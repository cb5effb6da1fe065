"""An engine from which nothing comes, though it says several times a second that it is there."""

from typing import TYPE_CHECKING

from sim.trace.events import AnyEvent, Notice, Severity

if TYPE_CHECKING:
    from sim.trace.model import Nanoseconds

SILENT = "the engine does not answer"
"""What a notice of it begins with."""
LOOK = 0.5
"""Real seconds between two looks whether something has come."""

_PATIENCE = 10
"""Looks without anything after which the person is told; a machine that slept makes one of them long."""
_PATIENCE_AT_FIRST = 60
"""Looks that an engine gets to import all that it needs."""


class Silence:
    """Turns what comes from an engine, and what does not, into batches. It belongs to the reader's thread."""

    def __init__(self) -> None:
        self._t: Nanoseconds = 0
        self._looks_left = _PATIENCE_AT_FIRST

    def nothing_came(self, stopped: bool) -> list[AnyEvent]:
        """Return what is to be told when a look found nothing; ``stopped``: its process cannot go on."""
        self._looks_left -= 1
        if self._looks_left != 0:
            return []
        why = "its process was stopped" if stopped else "code in C keeps it, or the machine has no time"
        return [Notice(self._t, Severity.WARN, f"{SILENT}: {why}")]

    def came(self, events: list[AnyEvent]) -> list[AnyEvent]:
        """Return what is to be told when a batch came, which may be empty."""
        was_silent, self._looks_left = self._looks_left <= 0, _PATIENCE
        again: list[AnyEvent] = [Notice(self._t, Severity.INFO, "the engine answers again")]
        if events:
            self._t = events[-1].t
        return [*again, *events] if was_silent else events
