"""The service calls of a run and which of them were without a reply at a moment."""

from operator import attrgetter

from sim.trace.events import CallId, ServiceCalled, ServiceReplied
from sim.trace.history import History
from sim.trace.intervals import Intervals, Lane, Row
from sim.trace.model import Call, Nanoseconds


class Calls:
    """Every call, in order of its sending."""

    def __init__(self) -> None:
        self.sent: History[Call] = History(attrgetter("sent"))
        self._by_row: list[Call] = []
        self._intervals = Intervals()
        self._lane = Lane(self._intervals)
        self._pending: dict[CallId, Row] = {}

    def send(self, event: ServiceCalled) -> None:
        """A request leaves."""
        call = Call(event.call, event.service, event.entity, event.request, event.t)
        row = self._intervals.open(event.t)
        self.sent.add(call)
        self._by_row.append(call)
        self._lane.add(row)
        self._pending[event.call] = row

    def reply(self, event: ServiceReplied) -> None:
        """An answer comes; one to no known call is passed over."""
        row = self._pending.pop(event.call, None)
        if row is None:
            return
        self._intervals.close(row, event.t)
        self._by_row[row].replied = event.t
        self._by_row[row].response = event.response

    def pending(self, at: Nanoseconds) -> tuple[Call, ...]:
        """The calls that had been sent and not answered at ``at``."""
        return tuple(self._by_row[row] for row in self._lane.covering(at))
