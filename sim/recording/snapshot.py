"""A snapshot of a running run, from which a recording can start later."""

from collections import Counter, defaultdict, deque
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from typing import Any, TypeAlias

from msgspec.structs import replace

from sim.trace import events as ev
from sim.trace.events import AnyEvent, EntityId, MessageId, ThreadId

_MOST_QUEUED = 1000
"""Messages kept for each queue: the depth of the deepest usual queue."""
_MOST_IN_TRANSIT = 100
"""Published messages kept because they may not have arrived yet."""

_Placed: TypeAlias = tuple[int, Any]
"""The sequence number of an event in the run, and the event."""


@dataclass
class _OpenCall:
    """An unfinished call of a callback: its start, its last suspension and resumption."""

    start: _Placed
    thread: ThreadId
    suspended: _Placed | None = None
    resumed: _Placed | None = None

    @property
    def is_suspended(self) -> bool:
        """Whether it is suspended."""
        return self.suspended is not None and self.resumed is None

    def events(self) -> list[_Placed]:
        """The events that describe it."""
        events = [self.start]
        if self.suspended is not None:
            # The suspension may have come on another thread than the start.
            place, event = self.suspended
            events.append((place, replace(event, thread=self.start[1].thread)))
        if self.resumed is not None:
            events.append(self.resumed)
        return events


class RunSnapshot:
    """Follows a run, and returns at any time those of its events on which later ones depend.

    These are its participants, the callbacks that run, wait or are suspended, where threads are in the code,
    the queues, the pending service calls, the last state of the robot, and all inputs, which a repetition
    needs. Finished calls and log lines are left out. Not thread-safe.
    """

    def __init__(self) -> None:
        self._place = 0
        self._end = 0
        self._latest: dict[Hashable, _Placed] = {}
        self._queued: defaultdict[EntityId, deque[_Placed]] = defaultdict(lambda: deque(maxlen=_MOST_QUEUED))
        self._published: dict[MessageId, _Placed] = {}
        self._running: defaultdict[EntityId, list[_OpenCall]] = defaultdict(list)
        self._waits: dict[EntityId, list[_Placed]] = {}

    def take(self, events: Iterable[AnyEvent]) -> None:
        """Follow a batch of events."""
        for event in events:
            self._place += 1
            self._end = max(self._end, event.t)
            self._take(event)
        if len(self._published) > 2 * _MOST_QUEUED:
            self._forget_messages()

    def events(self) -> list[AnyEvent]:
        """The events, in the order in which they happened."""
        self._forget_messages()
        placed = [*self._latest.values(), *self._published.values()]
        for queue in self._queued.values():
            placed += queue
        for calls in self._running.values():
            for call in calls:
                placed += call.events()
        for waits in self._waits.values():
            placed += waits
        return _with_depths((event for _, event in sorted(placed, key=lambda each: each[0])), self._end)

    def _take(self, event: Any) -> None:
        handle = _HANDLERS.get(event.__class__)
        if handle is not None:
            handle(self, event)
        elif event.__class__ in _KEYS:
            kind, field = _KEYS[event.__class__]
            self._latest[kind, getattr(event, field) if field else 0] = (self._place, event)

    def _take_published(self, event: ev.Published) -> None:
        self._published[event.message] = (self._place, event)

    def _take_answer(self, event: ev.ServiceReplied | ev.CallUnblocked) -> None:
        """Forget a call and its reply; both are kept while a thread is blocked in it."""
        block, reply = ("block", event.call), ("reply", event.call)
        if isinstance(event, ev.ServiceReplied):
            self._latest[reply] = (self._place, event)
        else:
            self._latest.pop(block, None)
        if reply in self._latest and block not in self._latest:
            del self._latest[reply]
            self._latest.pop(("call", event.call), None)

    def _take_gone(self, event: ev.EntityGone) -> None:
        self._queued.pop(event.entity, None)
        self._waits.pop(event.entity, None)
        self._latest.pop(("entity", event.entity), None)

    def _take_line_end(self, event: ev.LineEnded) -> None:
        self._latest.pop(("line", event.line), None)

    def _take_input(self, event: ev.InputGiven) -> None:
        self._latest["input", self._place] = (self._place, event)

    def _take_start(self, event: ev.CallbackStarted) -> None:
        self._running[event.entity].append(_OpenCall((self._place, event), event.thread))
        self._leave_queue(event)

    def _take_suspension(self, event: ev.CallbackSuspended) -> None:
        self._latest.pop(("position", event.thread), None)
        here = self._here(event)
        if here is not None:
            here.suspended, here.resumed = (self._place, event), None

    def _take_resumption(self, event: ev.CallbackResumed) -> None:
        awaiting = self._awaiting(event.entity)
        if awaiting is not None:
            awaiting.resumed, awaiting.thread = (self._place, event), event.thread

    def _take_end(self, event: ev.CallbackEnded) -> None:
        self._latest.pop(("position", event.thread), None)
        over = self._here(event) or self._awaiting(event.entity)
        if over is not None:
            self._running[event.entity].remove(over)

    def _here(self, event: ev.CallbackSuspended | ev.CallbackEnded) -> _OpenCall | None:
        """The innermost running call on the event's thread."""
        for each in reversed(self._running[event.entity]):
            if each.thread == event.thread and not each.is_suspended:
                return each
        return None

    def _awaiting(self, entity: EntityId) -> _OpenCall | None:
        """The call that has been suspended longest."""
        suspended = (each for each in self._running[entity] if each.is_suspended)
        return min(suspended, key=lambda each: each.suspended or each.start, default=None)

    def _take_queue(self, event: Any) -> None:
        if isinstance(event, ev.EntityReady):
            self._queued[event.entity].append((self._place, event))
            self._shorten(event)
        else:
            self._leave_queue(event)

    def _leave_queue(self, event: ev.CallbackStarted | ev.MessageDropped) -> None:
        """Remove a message: usually the oldest, but a newer one may expire first."""
        queue = self._queued[event.entity]
        gone = next((each for each in queue if each[1].message == event.message), None)
        if gone is not None:
            queue.remove(gone)
        self._shorten(event)

    def _shorten(self, event: ev.EntityReady | ev.CallbackStarted | ev.MessageDropped) -> None:
        queue = self._queued[event.entity]
        while len(queue) > event.depth:
            queue.popleft()

    def _take_wait(self, event: Any) -> None:
        """Keep the first and the latest event of a wait: the first has its start, the latest its reason."""
        known = self._waits.get(event.entity, [])
        goes_on = isinstance(event, ev.WaitEnded) or _is_same_wait(known, event)
        if goes_on and not known:
            return
        begun = [known[0]] if goes_on else []
        ended = [each for each in known[-1:] if goes_on and isinstance(each[1], ev.WaitEnded)]
        self._waits[event.entity] = [*begun, *ended, (self._place, event)]

    def _forget_messages(self) -> None:
        queued = {ready.message for queue in self._queued.values() for _, ready in queue}
        queued.update(list(self._published)[-_MOST_IN_TRANSIT:])
        self._published = {number: each for number, each in self._published.items() if number in queued}


def _is_same_wait(known: list[_Placed], event: ev.WaitStarted) -> bool:
    if not known:
        return False
    over = isinstance(known[-1][1], ev.WaitEnded)
    starts = [each.since for _, each in known if isinstance(each, ev.WaitStarted)]
    return not over or starts[-1] == event.since


def _with_depths(events: Iterable[Any], end: int) -> list[AnyEvent]:
    """The events, of a trace that is known from ``end`` on, with queue depths of these messages alone."""
    counts: Counter[EntityId] = Counter()
    numbered: list[AnyEvent] = []
    for event in events:
        match event:
            case ev.RunStarted():
                numbered.append(replace(event, known_from=end))
            case ev.EntityReady(entity=entity):
                counts[entity] += 1
                numbered.append(replace(event, depth=counts[entity]))
            case ev.CallbackStarted(entity=entity):
                numbered.append(replace(event, depth=counts[entity]))
            case _:
                numbered.append(event)
    return numbered


_HANDLERS: dict[type, Callable[[RunSnapshot, Any], None]] = {
    ev.CallbackStarted: RunSnapshot._take_start,
    ev.CallbackSuspended: RunSnapshot._take_suspension,
    ev.CallbackResumed: RunSnapshot._take_resumption,
    ev.CallbackEnded: RunSnapshot._take_end,
    ev.EntityReady: RunSnapshot._take_queue,
    ev.MessageDropped: RunSnapshot._take_queue,
    ev.WaitStarted: RunSnapshot._take_wait,
    ev.WaitEnded: RunSnapshot._take_wait,
    ev.Published: RunSnapshot._take_published,
    ev.ServiceReplied: RunSnapshot._take_answer,
    ev.CallUnblocked: RunSnapshot._take_answer,
    ev.EntityGone: RunSnapshot._take_gone,
    ev.InputGiven: RunSnapshot._take_input,
    ev.LineEnded: RunSnapshot._take_line_end,
}
_KEYS: dict[type, tuple[str, str]] = {
    ev.RunStarted: ("run", ""),
    ev.ProcessAppeared: ("process", "process"),
    ev.ThreadAppeared: ("thread", "thread"),
    ev.ExecutorAppeared: ("executor", "executor"),
    ev.NodeAppeared: ("node", "node"),
    ev.GroupAppeared: ("group", "group"),
    ev.EntityAppeared: ("entity", "entity"),
    ev.QosMismatched: ("mismatch", "topic"),
    ev.TimesKept: ("times kept", "node"),
    ev.SynchroniserJudged: ("synchroniser", "made_at"),
    ev.TopicAppeared: ("topic", "topic"),
    ev.ServiceCalled: ("call", "call"),
    ev.RequestLost: ("lost request", "call"),
    ev.CallBlocked: ("block", "call"),
    ev.CallbackAt: ("position", "thread"),
    ev.ProgramAt: ("program", "process"),
    ev.OwnThreadAt: ("own thread", "number"),
    ev.KeyboardAsked: ("keyboard", ""),
    ev.LineGiven: ("line", "line"),
    ev.ArenaShown: ("arena", ""),
    ev.RobotMoved: ("robot", ""),
    ev.VelocityCommanded: ("velocity", ""),
    ev.Scanned: ("scan", ""),
    ev.EventsLost: ("lost", ""),
    ev.ContentsLost: ("contents lost", ""),
}
"""Events of which only the latest counts: the kind of its subject, and the field with the subject's id."""
