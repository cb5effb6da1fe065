"""What was sent on each topic and to each service, and by which call of a callback."""

from collections.abc import Callable, Collection, Sequence

from sim.trace.events import CallId, MessageId
from sim.trace.lazy import LazySequence
from sim.trace.model import Nanoseconds, Sending, Span
from sim.trace.storage.intervals import RowId
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import IntegerTable

_NOBODY: RowId = -1


class Sendings:
    """The messages of topics and the requests of services, by name, in order of time."""

    def __init__(self, spill: SpillFile) -> None:
        self._spill = spill
        self._tables: dict[str, IntegerTable] = {}

    def add(self, name: str, at: Nanoseconds, number: MessageId | CallId, sender: RowId | None) -> None:
        """Add a message or request; ``sender`` is the span in which it was sent."""
        if name not in self._tables:
            self._tables[name] = IntegerTable(self._spill, 3)
        self._tables[name].add([at, number, _NOBODY if sender is None else sender])

    @property
    def names(self) -> Collection[str]:
        """The topics and services, in order of their first messages."""
        return self._tables.keys()

    def on(self, name: str, span: Callable[[RowId], Span]) -> Sequence[Sending]:
        """What was sent on a topic, or to a service."""
        table = self._tables.get(name)
        if table is None:
            return ()

        def sending(row: RowId) -> Sending:
            at, number, sender = table.row(row)
            return Sending(at, number, None if sender == _NOBODY else span(sender))

        return LazySequence(range(len(table)), sending)
