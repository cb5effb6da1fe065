"""Drops events after the request to end a program, so that checks and figures do not count them."""

from collections.abc import Iterable, Iterator

import msgspec

from sim.trace.events import AnyEvent, Logged, Notice, Printed, RunEnded, RunEnding
from sim.trace.model import Nanoseconds

_KEPT = (Logged, Notice, Printed, RunEnded)


class UntilEnding:
    """Cuts a run's events at the request to end its program.

    Later log lines, printed lines, notices and the end of the run are kept, with that time.
    """

    def __init__(self) -> None:
        self._ending_at: Nanoseconds | None = None

    def cut(self, events: Iterable[AnyEvent]) -> Iterator[AnyEvent]:
        """Yield the next events that are not cut."""
        for event in events:
            if self._ending_at is None:
                yield event
                if isinstance(event, RunEnding):
                    self._ending_at = event.t
            elif isinstance(event, _KEPT):
                yield msgspec.structs.replace(event, t=min(event.t, self._ending_at))
