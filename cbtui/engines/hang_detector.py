"""Detects an engine from which nothing comes, though it sends a heartbeat several times a second."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from sim.trace.events import AnyEvent, Notice, NoticeKind, Severity

if TYPE_CHECKING:
    from sim.trace.model import Nanoseconds

LOOK = 0.5
"""Real seconds between two looks whether something has come."""

_PATIENCE = 10
"""Looks without anything after which the person is told; a machine that slept makes one of them long."""
_PATIENCE_AT_FIRST = 60
"""Looks that an engine gets to import all that it needs."""


def why_silent(stands: str, stands_later: str) -> str:
    """Why an engine does not answer whose program stood at these places in its code; "" for nowhere.

    Python code that computes moves on, and lets the engine's own threads in between.
    """
    if not stands_later:
        return "the machine has no time for it"
    if stands == stands_later:
        return f"code in C keeps it, called from {stands}"
    return f"the program computes ({stands_later}), and the machine has no time for both"


class HangDetector:
    """Turns what comes from an engine, and what does not, into batches. It belongs to the reader's thread."""

    def __init__(self) -> None:
        self._t: Nanoseconds = 0
        self._looks_left = _PATIENCE_AT_FIRST

    def nothing_came(self, why: Callable[[], str]) -> list[AnyEvent]:
        """Return what is to be told when a look found nothing; ``why`` is asked for the reason then."""
        self._looks_left -= 1
        if self._looks_left != 0:
            return []
        text = f"the engine does not answer: {why()}"
        return [Notice(self._t, Severity.WARN, text, kind=NoticeKind.ENGINE_SILENT)]

    def came(self, events: list[AnyEvent]) -> list[AnyEvent]:
        """Return what is to be told when a batch came, which may be empty."""
        was_silent, self._looks_left = self._looks_left <= 0, _PATIENCE
        again: list[AnyEvent] = [Notice(self._t, Severity.INFO, "the engine answers again")]
        if events:
            self._t = events[-1].t
        return [*again, *events] if was_silent else events
