"""Translates what probes send into the trace's events: in the run's time, in order, messages linked."""

import heapq
from collections.abc import Callable, Iterable, Iterator
from itertools import count

import msgspec

from sim.real.arrivals import Arrivals, SentMessage
from sim.real.hung_callbacks import HungCallbacks
from sim.real.left_open import LeftOpen
from sim.real.sampled_positions import position_of
from sim.real.wire import (
    At,
    Called,
    Hello,
    Interrupted,
    Left,
    MessageTaken,
    ProbeLine,
    ProgramWanted,
    Replied,
    Sent,
    Uncaught,
    infinite,
)
from sim.trace.events import (
    AnyEvent,
    CallbackStarted,
    CallBlocked,
    CallUnblocked,
    EntityAppeared,
    EntityGone,
    EntityReady,
    EventsLost,
    NodeAppeared,
    ProcessEnded,
    Published,
    RequestLost,
    ServiceCalled,
    ServiceReplied,
    ThreadAppeared,
    TraceEvent,
    WaitEnded,
    WaitStarted,
)

HOLD = 30_000_000
"""Nanoseconds for which events are held back, so that those of several processes can be put in order."""

_CALLS = 10_000
"""The most calls whose numbers are kept until their replies come."""


class Translation:
    """Takes lines from the probes of a run, and returns events in the order in which they happened.

    The run begins with the first node that is known at the first release, so imports before it do not count.
    ``begin`` gets that moment in monotonic nanoseconds. Messages and calls are numbered in the order of
    sending.
    """

    def __init__(self, record: Callable[[AnyEvent], None], begin: Callable[[int], None]) -> None:
        self._record = record
        self._begin = begin
        self._start: int | None = None
        self._first_node: int | None = None
        """When the first node appeared."""
        self._held: list[tuple[int, int, ProbeLine]] = []
        self._order = count()
        self._arrivals = Arrivals()
        self._messages = count(1)
        self._calls: dict[int, int] = {}
        """The numbers of the latest calls on the trace, by their probes' numbers."""
        self._answered: dict[int, None] = {}
        """The latest calls whose replies were told of."""
        self._lost: dict[int, int] = {}
        self._left_open = LeftOpen()
        self._hung = HungCallbacks()

    def begin_at(self, moment: int) -> None:
        """Have the run begin, if it has not yet: at ``moment``, or when the first known node appeared."""
        if self._start is None:
            self._start = min(moment, self._first_node or moment)
            self._begin(self._start)

    def take(self, lines: Iterable[ProbeLine], process: int = 0) -> None:
        """Take lines of a program's probe; ``process`` is its number on the trace, 0 for a single one."""
        for line in lines:
            match line:
                case Hello() | Uncaught() | Left() | ProgramWanted() | Interrupted():
                    continue
                case At(entity=0) if process:
                    continue  # the trace has room for one program's position
                case NodeAppeared(t=t):
                    self._first_node = min(t, self._first_node or t)
                case ThreadAppeared():
                    line = msgspec.structs.replace(line, process=process)  # noqa: PLW2901
                case EntityAppeared():
                    self._left_open.appeared(line, process)
                case EventsLost(t=t, count=lost):
                    self._lost[process] = lost
                    line = EventsLost(t, sum(self._lost.values()))  # noqa: PLW2901
                case _:
                    pass
            heapq.heappush(self._held, (line.t, next(self._order), line))

    def release(self, until: int) -> None:
        """Return the events up to a moment in monotonic nanoseconds; none before there is a node."""
        if self._first_node is not None:
            self.begin_at(self._first_node)
        if self._start is None:
            return
        while self._held and self._held[0][0] <= until:
            t, _, line = heapq.heappop(self._held)
            for event in self._translated(line, max(0, t - self._start)):
                self._left_open.follow(event)
                self._hung.follow(event)
                self._record(event)
        for notice in self._hung.look(until - self._start):
            self._record(notice)

    def _translated(self, line: ProbeLine, t: int) -> Iterator[AnyEvent]:
        arrivals = self._arrivals
        match line:
            case Sent():
                message = next(self._messages)
                yield Published(t, message, line.topic, line.node, line.entity)
                yield from arrivals.sent(
                    t, line.topic, SentMessage(message, line.node, line.before, line.after)
                )
            case Called():
                call = self._calls[line.call] = next(self._messages)
                if len(self._calls) > _CALLS:
                    del self._calls[next(iter(self._calls))]
                yield ServiceCalled(t, call, line.service, line.entity, line.request)
                arrivals.called(line.service, call)
                yield from arrivals.sent(t, line.service, SentMessage(call, 0, line.before, line.after))
            case MessageTaken():
                number, left, lost = arrivals.taken(t, line.entity, line.sent)
                yield from lost
                yield CallbackStarted(t, line.entity, line.thread, number, line.age, left)
            case Replied(response=response):
                service, call = arrivals.replied(line.entity, line.sent)
                if call:
                    yield from self._replied(t, call, service, response)
            case At():
                self._hung.waits_for_job(line.thread, line.job)
                yield position_of(line, t)
            case ProcessEnded(process=process):
                yield from self._left_open.closed(process, t)
                yield msgspec.structs.replace(line, t=t)
            case EntityReady():
                yield from arrivals.ready(t, line.entity)
            case WaitStarted(since=since):
                assert self._start is not None
                yield msgspec.structs.replace(line, t=t, since=max(0, since - self._start))
            case _:
                yield from self._with_number(line, t)

    def _replied(self, t: int, call: int, service: str, response: str) -> Iterator[AnyEvent]:
        """A reply; the service's process reports it, and so does the caller's if that is watched."""
        if call not in self._answered:
            self._answered[call] = None
            if len(self._answered) > _CALLS:
                del self._answered[next(iter(self._answered))]
            yield ServiceReplied(t, call, service, response)

    def _with_number(self, line: ProbeLine, t: int) -> Iterator[AnyEvent]:
        """An event of the trace, with the number of the call that it is about."""
        arrivals = self._arrivals
        match line:
            case ServiceReplied(service=service, response=response):
                call = self._calls.get(line.call, 0)
                arrivals.reply_arrived(service, call)
                yield from self._replied(t, call, service, response)
            case RequestLost():
                call = self._calls.get(line.call, 0)
                arrivals.reply_arrived(line.service, call)
                yield msgspec.structs.replace(line, t=t, call=call)
            case CallBlocked() | CallUnblocked():
                yield msgspec.structs.replace(line, t=t, call=self._calls.get(line.call, 0))
            case CallbackStarted(message=call) if call:
                number, left = arrivals.reply_taken(line.entity, self._calls.get(call, 0))
                yield msgspec.structs.replace(line, t=t, message=number, depth=left)
            case TraceEvent():
                if isinstance(line, EntityAppeared):
                    arrivals.appeared(line)
                elif isinstance(line, EntityGone):
                    arrivals.gone(line.entity)
                elif isinstance(line, WaitEnded):
                    arrivals.waits_no_more(line.entity)
                yield infinite(msgspec.structs.replace(line, t=t))
