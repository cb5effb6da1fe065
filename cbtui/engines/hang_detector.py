"""Detects an engine that has stopped sending its heartbeat, which comes several times a second."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from sim.trace.events import AnyEvent, Notice, NoticeKind, Severity

if TYPE_CHECKING:
    from sim.trace.model import Nanoseconds

LOOK = 0.5
"""Real seconds to wait for data before a look counts as empty."""

_PATIENCE = 10
"""Looks without anything after which the person is told; a machine that slept makes one of them long."""
_PATIENCE_AT_FIRST = 60
"""Looks that an engine gets to import all that it needs."""


def why_silent(stands: str, stands_later: str) -> str:
    """Explain a hang from two samples of where the program stands in its code; "" is nowhere.

    Python code that computes moves on, and lets the engine's own threads in between.
    """
    if not stands_later:
        return "the machine has no time for it"
    if stands == stands_later:
        return f"code in C keeps it, called from {stands}"
    return f"the program computes ({stands_later}), and the machine has no time for both"


class HangDetector:
    """Adds notices on a silent engine to its batches. Used on the reader thread only."""

    def __init__(self) -> None:
        self._t: Nanoseconds = 0
        self._looks_left = _PATIENCE_AT_FIRST

    def nothing_came(self, why: Callable[[], str]) -> list[AnyEvent]:
        """Return the notice that is due after a look without data; ``why`` gives its reason."""
        self._looks_left -= 1
        if self._looks_left != 0:
            return []
        text = f"the engine does not answer: {why()}"
        return [Notice(self._t, Severity.WARN, text, kind=NoticeKind.ENGINE_SILENT)]

    def came(self, events: list[AnyEvent]) -> list[AnyEvent]:
        """Return the batch that came, after a notice if the engine had been silent. It may be empty."""
        was_silent, self._looks_left = self._looks_left <= 0, _PATIENCE
        again: list[AnyEvent] = [Notice(self._t, Severity.INFO, "the engine answers again")]
        if events:
            self._t = events[-1].t
        return [*again, *events] if was_silent else events
