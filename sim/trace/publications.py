"""The publications of a run: time, node and callback of each message."""

from sim.trace.events import MessageId, Published
from sim.trace.model import Nanoseconds, Publication
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import IntegerTable

_TIME, _NODE, _ENTITY = range(1, 4)


class Publications:
    """The publications of a run, by message id."""

    __slots__ = ("_latest", "_table")

    def __init__(self, spill: SpillFile) -> None:
        self._table = IntegerTable(spill, 4)
        self._latest: MessageId | None = None

    def add(self, event: Published) -> None:
        """Add a publication; the first of a message counts."""
        row = [event.message, event.t, event.node, event.entity]
        if self._latest is None or event.message > self._latest:
            self._latest = event.message
            self._table.append(row)
        elif self._table.find(event.message) is None:
            self._table.add(row)

    def time_of(self, message: MessageId) -> Nanoseconds | None:
        """When a message was published; None if it is unknown."""
        place = self._table.find(message)
        return None if place is None else self._table.cell(place, _TIME)

    def of(self, message: MessageId) -> Publication | None:
        """The publication of a message; None if it is unknown."""
        place = self._table.find(message)
        if place is None:
            return None
        return Publication(*(self._table.cell(place, column) for column in (_TIME, _NODE, _ENTITY)))
