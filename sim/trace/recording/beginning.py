"""What a recording needs to know of a run that was going on when it began."""

from collections import Counter, defaultdict, deque
from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from typing import Any, TypeAlias

from msgspec.structs import replace

from sim.trace import events as ev
from sim.trace.events import AnyEvent, EntityId, MessageId, ThreadId

_MOST_QUEUED = 1000
"""Messages of a queue that are remembered: as many as the deepest usual one holds."""
_MOST_ON_THE_WAY = 100
"""Messages that are remembered since they may arrive yet."""

_Placed: TypeAlias = tuple[int, Any]
"""An event and its place in the run."""


@dataclass
class _Activation:
    """A callback that has begun: where it was suspended last, and where it went on."""

    start: _Placed
    thread: ThreadId
    suspended: _Placed | None = None
    resumed: _Placed | None = None

    @property
    def is_suspended(self) -> bool:
        """Whether it awaits something."""
        return self.suspended is not None and self.resumed is None

    def events(self) -> list[_Placed]:
        """What has to be known of it."""
        told = [self.start]
        if self.suspended is not None:
            # In between it may have been on other threads.
            place, event = self.suspended
            told.append((place, replace(event, thread=self.start[1].thread)))
        if self.resumed is not None:
            told.append(self.resumed)
        return told


class Beginning:
    """Follows a run, and tells at any time those of its events that later ones build on.

    That is who takes part, what runs, waits and is queued now, which calls are out, and what was last seen of
    the robot, and all inputs, which a repetition needs; finished
    calls, log lines and the like are not among them. Not thread-safe.
    """

    def __init__(self) -> None:
        self._place = 0
        self._latest: dict[Hashable, _Placed] = {}
        self._queued: defaultdict[EntityId, deque[_Placed]] = defaultdict(lambda: deque(maxlen=_MOST_QUEUED))
        self._published: dict[MessageId, _Placed] = {}
        self._running: defaultdict[EntityId, list[_Activation]] = defaultdict(list)
        self._waits: dict[EntityId, list[_Placed]] = {}

    def take(self, events: Iterable[AnyEvent]) -> None:
        """Follow a batch of events."""
        for event in events:
            self._place += 1
            self._take(event)
        if len(self._published) > 2 * _MOST_QUEUED:
            self._forget_messages()

    def events(self) -> list[AnyEvent]:
        """The events, in the order in which they happened."""
        self._forget_messages()
        placed = [*self._latest.values(), *self._published.values()]
        for queue in self._queued.values():
            placed += queue
        for activations in self._running.values():
            for activation in activations:
                placed += activation.events()
        for waits in self._waits.values():
            placed += waits
        return _with_depths(event for _, event in sorted(placed, key=lambda each: each[0]))

    def _take(self, event: Any) -> None:
        match event:
            case ev.CallbackStarted() | ev.CallbackSuspended() | ev.CallbackResumed() | ev.CallbackEnded():
                self._take_callback(event)
            case ev.EntityReady() | ev.MessageDropped():
                self._take_queue(event)
            case ev.WaitStarted() | ev.WaitEnded():
                self._take_wait(event)
            case ev.Published():
                self._published[event.message] = (self._place, event)
            case ev.EntityGone(entity=entity):
                self._queued.pop(entity, None)
                self._waits.pop(entity, None)
                self._latest.pop(("entity", entity), None)
            case ev.ServiceReplied():
                self._latest.pop(("call", event.call), None)
            case ev.CallUnblocked():
                self._latest.pop(("block", event.call), None)
            case ev.InputGiven():
                self._latest["input", self._place] = (self._place, event)
            case ev.LineEnded():
                self._latest.pop(("line", event.line), None)
            case _ if type(event) in _KEYS:
                kind, field = _KEYS[type(event)]
                self._latest[kind, getattr(event, field) if field else 0] = (self._place, event)

    def _take_callback(self, event: Any) -> None:
        activations = self._running[event.entity]
        here = next(
            (each for each in reversed(activations) if each.thread == event.thread and not each.is_suspended),
            None,
        )
        awaiting = min(
            (each for each in activations if each.is_suspended),
            key=lambda each: each.suspended or each.start,
            default=None,
        )
        match event:
            case ev.CallbackStarted():
                activations.append(_Activation((self._place, event), event.thread))
                self._shorten(event.entity, event.depth)
            case ev.CallbackSuspended() if here is not None:
                here.suspended, here.resumed = (self._place, event), None
            case ev.CallbackResumed() if awaiting is not None:
                awaiting.resumed, awaiting.thread = (self._place, event), event.thread
            case ev.CallbackEnded():
                over = here or awaiting
                if over is not None:
                    activations.remove(over)

    def _take_queue(self, event: Any) -> None:
        if isinstance(event, ev.EntityReady):
            self._queued[event.entity].append((self._place, event))
        self._shorten(event.entity, event.depth)

    def _shorten(self, entity: EntityId, depth: int) -> None:
        queue = self._queued[entity]
        while len(queue) > depth:
            queue.popleft()

    def _take_wait(self, event: Any) -> None:
        """Keep the first event of a wait besides its latest: it tells when a change of the reason came."""
        known = self._waits.get(event.entity, [])
        goes_on = isinstance(event, ev.WaitEnded) or _is_same_wait(known, event)
        if goes_on and not known:
            return
        begun = [known[0]] if goes_on else []
        ended = [each for each in known[-1:] if goes_on and isinstance(each[1], ev.WaitEnded)]
        self._waits[event.entity] = [*begun, *ended, (self._place, event)]

    def _forget_messages(self) -> None:
        queued = {ready.message for queue in self._queued.values() for _, ready in queue}
        queued.update(list(self._published)[-_MOST_ON_THE_WAY:])
        self._published = {number: each for number, each in self._published.items() if number in queued}


def _is_same_wait(known: list[_Placed], event: ev.WaitStarted) -> bool:
    if not known:
        return False
    over = isinstance(known[-1][1], ev.WaitEnded)
    starts = [each.since for _, each in known if isinstance(each, ev.WaitStarted)]
    return not over or starts[-1] == event.since


def _with_depths(events: Iterable[Any]) -> list[AnyEvent]:
    """The events with the depths that queues have when only these messages ever came."""
    counts: Counter[EntityId] = Counter()
    told: list[AnyEvent] = []
    for event in events:
        match event:
            case ev.EntityReady(entity=entity):
                counts[entity] += 1
                told.append(replace(event, depth=counts[entity]))
            case ev.CallbackStarted(entity=entity):
                told.append(replace(event, depth=counts[entity]))
            case _:
                told.append(event)
    return told


_KEYS: dict[type, tuple[str, str]] = {
    ev.RunStarted: ("run", ""),
    ev.ProcessAppeared: ("process", "process"),
    ev.ThreadAppeared: ("thread", "thread"),
    ev.ExecutorAppeared: ("executor", "executor"),
    ev.NodeAppeared: ("node", "node"),
    ev.GroupAppeared: ("group", "group"),
    ev.EntityAppeared: ("entity", "entity"),
    ev.TopicAppeared: ("topic", "topic"),
    ev.ServiceCalled: ("call", "call"),
    ev.CallBlocked: ("block", "call"),
    ev.LineGiven: ("line", "line"),
    ev.ArenaShown: ("arena", ""),
    ev.RobotMoved: ("robot", ""),
    ev.VelocityCommanded: ("velocity", ""),
    ev.Scanned: ("scan", ""),
    ev.EventsLost: ("lost", ""),
    ev.ContentsLost: ("contents lost", ""),
}
"""How events are told apart of which the latest counts: what they are of, and the field with its number."""
