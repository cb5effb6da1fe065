"""The service calls of a run, and those pending at any moment."""

from collections.abc import Collection, Sequence

from sim.trace.events import CallId, RequestLost, ServiceCalled, ServiceReplied
from sim.trace.lazy import LazySequence
from sim.trace.model import Call, Nanoseconds, Window
from sim.trace.storage.history import History
from sim.trace.storage.intervals import IntervalLane, Intervals, RowId, end_or_none
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import IntegerTable

NEWEST_KEPT = 1024


class ServiceCalls(Intervals):
    """The table of all calls, with a cache of ``Call`` objects for the newest."""

    CALL, CALLER, SERVICE, LOST, RESPONSE = range(2, 7)

    def __init__(self, spill: SpillFile) -> None:
        super().__init__(spill, more=5)
        self._services: dict[str, int] = {}
        self._requests = _texts(spill)
        self._responses = _texts(spill)
        self._responses.add("")
        self._lane = IntervalLane(self)
        self._in_order = IntegerTable(spill, 2)
        self._numbered = IntegerTable(spill, 2)
        self._pending: dict[CallId, RowId] = {}
        self._newest: dict[RowId, Call] = {}

    def send(self, event: ServiceCalled) -> None:
        """Add a call."""
        service = self._services.setdefault(event.service, len(self._services))
        row = self.open(event.t, event.call, event.entity, service, 0, 0)
        self._requests.add(event.request)
        self._lane.add(row)
        self._in_order.add([event.t, row])
        self._numbered.add([event.call, row])
        self._pending[event.call] = row
        self._newest[row] = Call(event.call, event.service, event.entity, event.request, event.t)
        self._newest.pop(row - NEWEST_KEPT, None)

    def reply(self, event: ServiceReplied) -> None:
        """Add the reply of a call; ignored for an unknown call."""
        row = self._pending.pop(event.call, None)
        if row is None:
            return
        self.table.change(row, self.RESPONSE, len(self._responses))
        self._responses.add(event.response)
        self.table.change(row, self.END, event.t)
        if row in self._newest:
            self._newest[row].replied = event.t
            self._newest[row].response = event.response

    def lose(self, event: RequestLost) -> None:
        """Note that a request was lost, as nobody offered the service."""
        row = self._pending.get(event.call)
        if row is not None:
            self.table.change(row, self.LOST, 1)
            if row in self._newest:
                self._newest[row].lost = True

    @property
    def services(self) -> Collection[str]:
        """The services that were called, in order of their first calls."""
        return self._services.keys()

    def sent(self) -> Sequence[Call]:
        """All calls, in order of sending."""
        return LazySequence(self._in_order.column(1, range(len(self._in_order))), self._call)

    def sent_at(self, call: CallId) -> Nanoseconds | None:
        """When a request was sent; None if it is unknown."""
        place = self._numbered.find(call)
        return None if place is None else self.started_at(self._numbered.cell(place, 1))

    def within(self, window: Window) -> Sequence[Call]:
        """The calls that were pending at some time in the window, in order of sending."""
        return LazySequence(self._lane.overlapping(window), self._call)

    def pending(self, at: Nanoseconds) -> tuple[Call, ...]:
        """The calls that were pending at ``at``."""
        return tuple(map(self._call, self._lane.covering(at)))

    def _call(self, row: RowId) -> Call:
        if row in self._newest:
            return self._newest[row]
        sent, end, call, caller, service, lost, response = self.table.row(row)
        return Call(
            call,
            list(self._services)[service],
            caller,
            self._requests[row],
            sent,
            end_or_none(end),
            self._responses[response],
            bool(lost),
        )


def _texts(spill: SpillFile) -> History[str]:
    return History(_no_time, str, spill)


def _no_time(_: str) -> Nanoseconds:
    """Texts have no time: they are kept in order of arrival."""
    return 0
