"""Leaves out what a program does after it was told to end, which no check or figure should count."""

from collections.abc import Iterable, Iterator

import msgspec

from sim.trace.events import AnyEvent, Logged, Notice, Printed, RunEnded, RunEnding
from sim.trace.model import Nanoseconds

_KEPT = (Logged, Notice, Printed, RunEnded)


class UntilEnding:
    """Ends a run's events at the time at which its program was told to end.

    What it logs and prints from there on, notices and the end of the run are kept, as of that moment.
    """

    def __init__(self) -> None:
        self._told_at: Nanoseconds | None = None

    def cut(self, events: Iterable[AnyEvent]) -> Iterator[AnyEvent]:
        """Return those of the next events that count."""
        for event in events:
            if self._told_at is None:
                yield event
                if isinstance(event, RunEnding):
                    self._told_at = event.t
            elif isinstance(event, _KEPT):
                yield msgspec.structs.replace(event, t=min(event.t, self._told_at))
