"""Detects an engine that no longer sends its heartbeat, which is due several times a second."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from sim.trace.events import AnyEvent, Notice, NoticeKind, Severity

if TYPE_CHECKING:
    from sim.trace.model import Nanoseconds

POLL_INTERVAL = 0.5
"""Real seconds to wait for data in one poll."""

_SILENT_POLLS = 10
"""Empty polls before an engine counts as silent; not seconds, as a suspended machine makes one long."""
_STARTING_POLLS = 60
"""Empty polls that a starting engine gets for its imports."""


def why_silent(stands: str, stands_later: str) -> str:
    """Explain a hang by two samples of the program's current line; "" if they are unknown.

    Python code that computes moves on between samples; C code that holds the GIL does not.
    """
    if not stands_later:
        return "the machine is too busy"
    if stands == stands_later:
        return f"code in C keeps it, called from {stands}"
    return f"the program computes ({stands_later}), and the machine is too busy for both"


class HangDetector:
    """Adds notices about a silent engine to its batches. Used on the reader thread only."""

    def __init__(self) -> None:
        self._t: Nanoseconds = 0
        self._polls_left = _STARTING_POLLS

    def polled_nothing(self, why: Callable[[], str]) -> list[AnyEvent]:
        """Count an empty poll; returns a notice, with its reason from ``why``, once the engine is silent."""
        self._polls_left -= 1
        if self._polls_left != 0:
            return []
        problem = f"engine does not answer: {why()}"
        kind = NoticeKind.ENGINE_SILENT
        return [Notice(self._t, Severity.WARN, f"the {problem}", kind=kind, problem=problem)]

    def received(self, events: list[AnyEvent]) -> list[AnyEvent]:
        """Return the batch that came, which may be empty, after a notice if the engine had been silent."""
        was_silent, self._polls_left = self._polls_left <= 0, _SILENT_POLLS
        again: list[AnyEvent] = [Notice(self._t, Severity.INFO, "the engine answers again")]
        if events:
            self._t = events[-1].t
        return [*again, *events] if was_silent else events
