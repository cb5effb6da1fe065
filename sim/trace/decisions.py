"""What threads did with callbacks, and what queues lost, in the order of the trace."""

from collections.abc import Iterator

from sim.trace.events import EntityId
from sim.trace.model import Deed, Nanoseconds, Window
from sim.trace.storage.intervals import RowId
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import IntegerTable


class Decisions:
    """Every deed of a run with its time and the number of its span, of its ``Blocked`` or of the entity."""

    def __init__(self, spill: SpillFile) -> None:
        self._table = IntegerTable(spill, 3)

    def add(self, at: Nanoseconds, deed: Deed, number: RowId | EntityId) -> None:
        """Add a deed, behind all others of the same time."""
        self._table.add([at, deed.value, number])

    def within(self, window: Window) -> Iterator[tuple[Deed, RowId | EntityId]]:
        """The deeds of a window."""
        for row in range(self._table.before(window.start), self._table.before(window.end)):
            _, deed, number = self._table.row(row)
            yield Deed(deed), number
