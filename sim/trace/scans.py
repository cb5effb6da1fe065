"""The laser scans of a run, and the times at which callbacks took them."""

from collections import OrderedDict
from operator import attrgetter

from sim.trace.events import MessageId, Scanned
from sim.trace.model import Nanoseconds, Window
from sim.trace.storage.history import History
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import IntegerTable

SCANS_IN_BLOCK = 32

SCANS_CACHED = 1024
"""The number of latest scans whose messages are kept in a cache."""


class Scans:
    """The scans in order of time, and the times at which callbacks took their messages."""

    def __init__(self, spill: SpillFile) -> None:
        self._scans: History[Scanned] = History(attrgetter("t"), Scanned, spill, SCANS_IN_BLOCK)
        self._times = IntegerTable(spill, 2)
        self._latest: OrderedDict[MessageId, None] = OrderedDict()
        self._oldest_cached: MessageId = 0
        self._taken = IntegerTable(spill, 2)

    def add(self, event: Scanned) -> None:
        """Add a scan."""
        self._scans.add(event)
        self._times.add([event.message, event.t])
        self._latest[event.message] = None
        if len(self._latest) > SCANS_CACHED:
            forgotten, _ = self._latest.popitem(last=False)
            self._oldest_cached = max(self._oldest_cached, forgotten + 1)

    def carried_by(self, message: MessageId) -> bool:
        """Whether a message carried a scan."""
        if message in self._latest:
            return True
        return message < self._oldest_cached and self._time_of(message) is not None

    def take(self, at: Nanoseconds, message: MessageId) -> None:
        """Note that a callback took a message with a scan."""
        self._taken.add([at, message])

    def latest(self, at: Nanoseconds) -> Scanned | None:
        """The last scan at or before ``at``."""
        return self._scans.latest(at)

    def taken(self, at: Nanoseconds) -> Scanned | None:
        """The latest scan that a callback had taken at ``at``."""
        place = self._taken.until(at)
        return self._of(self._taken.cell(place - 1, 1)) if place else None

    def _of(self, message: MessageId) -> Scanned | None:
        time = self._time_of(message)
        if time is None:
            return None
        same_time = self._scans.within(Window(time, time + 1))
        return next((scan for scan in reversed(same_time) if scan.message == message), None)

    def _time_of(self, message: MessageId) -> Nanoseconds | None:
        place = self._times.find(message)
        return None if place is None else self._times.cell(place, 1)
