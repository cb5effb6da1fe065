"""Random legal runs: a small system of threads, queues and groups, driven by random choices."""

from collections import deque
from dataclasses import dataclass, field

from hypothesis import strategies as st

from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackFailed,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    CallBlocked,
    CallUnblocked,
    EntityAppeared,
    EntityId,
    EntityKind,
    EntityReady,
    GroupAppeared,
    GroupId,
    GroupKind,
    Logged,
    MessageDropped,
    NodeAppeared,
    Published,
    Reason,
    RobotMoved,
    RunStarted,
    Scanned,
    ServiceCalled,
    ServiceReplied,
    Severity,
    ThreadAppeared,
    ThreadId,
    WaitEnded,
    WaitStarted,
)

THREADS = (1, 2, 3)
GROUP_OF: dict[EntityId, GroupId] = {1: 1, 2: 1, 3: 2, 4: 2, 5: 3}
GROUP_KINDS = {1: GroupKind.EXCLUSIVE, 2: GroupKind.REENTRANT, 3: GroupKind.EXCLUSIVE}
KINDS = {
    1: EntityKind.SUBSCRIPTION,
    2: EntityKind.TIMER,
    3: EntityKind.SUBSCRIPTION,
    4: EntityKind.SERVICE,
    5: EntityKind.SUBSCRIPTION,
}
DEPTH = 2
REASONS = tuple(Reason)


@dataclass(slots=True)
class System:
    """What the engine would know while it writes a run."""

    now: int = 0
    events: list[AnyEvent] = field(default_factory=list)
    queues: dict[EntityId, deque[int]] = field(default_factory=lambda: {e: deque() for e in GROUP_OF})
    stacks: dict[ThreadId, list[EntityId]] = field(default_factory=lambda: {t: [] for t in THREADS})
    suspended: list[EntityId] = field(default_factory=list)
    waiting: dict[EntityId, int] = field(default_factory=dict)
    calls: list[int] = field(default_factory=list)
    blocked: dict[ThreadId, int] = field(default_factory=dict)
    last_message: int = 0
    last_call: int = 0

    def __post_init__(self) -> None:
        self.events += [RunStarted(0, "system", "virtual", 0), NodeAppeared(0, 1, "/node")]
        self.events += [ThreadAppeared(0, thread, f"worker {thread}") for thread in THREADS]
        self.events += [GroupAppeared(0, group, 1, kind, "Group") for group, kind in GROUP_KINDS.items()]
        self.events += [
            EntityAppeared(0, e, 1, group, KINDS[e], f"/topic{e}", f"callback{e}", "node.py", 1, 2, DEPTH, 0)
            for e, group in GROUP_OF.items()
        ]

    def message(self, entity: EntityId, thread: ThreadId) -> None:
        """A message comes, with a scan on every third; every fourth was not seen to be published.

        To a service comes a request.
        """
        message = self._request(entity) if KINDS[entity] is EntityKind.SERVICE else self._publish(entity)
        queue = self.queues[entity]
        if len(queue) == DEPTH:
            self.events.append(MessageDropped(self.now, entity, DEPTH, queue.popleft()))
        queue.append(message)
        self.events.append(EntityReady(self.now, entity, len(queue), message))

    def _publish(self, entity: EntityId) -> int:
        self.last_message += 1
        message = self.last_message
        if message % 4:
            self.events.append(Published(self.now, message, f"/topic{entity}", 0, 0))
        if message % 3 == 0:
            self.events.append(Scanned(self.now, message, bytes([message % 256, 0])))
        return message

    def _request(self, entity: EntityId) -> int:
        self.call(entity, 0)
        return self.last_call

    def expire(self, entity: EntityId, thread: ThreadId) -> None:
        """One of the messages in a queue is too old, the newest even if it was given less time to live."""
        queue = self.queues[entity]
        if queue:
            lost = queue[thread % len(queue)]
            queue.remove(lost)
            self.events.append(MessageDropped(self.now, entity, len(queue), lost))

    def start(self, entity: EntityId, thread: ThreadId) -> None:
        """A callback starts, also inside another one, if its group lets it."""
        inside = [*self.suspended, *(each for stack in self.stacks.values() for each in stack)]
        group = GROUP_OF[entity]
        held = group in (GROUP_OF[each] for each in inside)
        if thread in self.blocked or (held and GROUP_KINDS[group] is GroupKind.EXCLUSIVE):
            return
        queue = self.queues[entity]
        message = queue.popleft() if queue else 0
        self.stacks[thread].append(entity)
        self.events.append(CallbackStarted(self.now, entity, thread, message, message * 7, len(queue)))

    def end(self, entity: EntityId, thread: ThreadId) -> None:
        """The innermost callback of a thread ends, every fifth by raising."""
        if self.stacks[thread] and thread not in self.blocked:
            innermost = self.stacks[thread].pop()
            if self.now % 5 == 0:
                self.events.append(CallbackFailed(self.now, innermost, thread, "Oops", "node.py", 3))
            self.events.append(CallbackEnded(self.now, innermost, thread))

    def suspend(self, entity: EntityId, thread: ThreadId) -> None:
        """The innermost callback of a thread awaits something."""
        if self.stacks[thread] and thread not in self.blocked:
            innermost = self.stacks[thread].pop()
            self.suspended.append(innermost)
            self.events.append(CallbackSuspended(self.now, innermost, thread))

    def resume(self, entity: EntityId, thread: ThreadId) -> None:
        """What has been suspended longest goes on."""
        if self.suspended and thread not in self.blocked:
            first = self.suspended.pop(0)
            self.stacks[thread].append(first)
            self.events.append(CallbackResumed(self.now, first, thread))

    def wait(self, entity: EntityId, thread: ThreadId) -> None:
        """An entity waits, for the first or another reason, since a little while."""
        since = self.waiting.setdefault(entity, max(0, self.now - thread + 1))
        reason = REASONS[(self.now + entity) % len(REASONS)]
        self.events.append(WaitStarted(self.now, entity, since, reason, thread, thread == 1))

    def stop_waiting(self, entity: EntityId, thread: ThreadId) -> None:
        """An entity waits no longer."""
        if self.waiting.pop(entity, None) is not None:
            self.events.append(WaitEnded(self.now, entity))

    def call(self, entity: EntityId, thread: ThreadId) -> None:
        """A service is called."""
        self.last_call += 1
        self.calls.append(self.last_call)
        self.events.append(ServiceCalled(self.now, self.last_call, "/service", entity, "request"))

    def reply(self, entity: EntityId, thread: ThreadId) -> None:
        """One of the calls is answered."""
        if self.calls:
            call = self.calls.pop(entity % len(self.calls))
            self.events.append(ServiceReplied(self.now, call, "/service", "response"))

    def block(self, entity: EntityId, thread: ThreadId) -> None:
        """A thread calls a service and stands still, in its innermost callback or in none."""
        if thread not in self.blocked:
            caller = self.stacks[thread][-1] if self.stacks[thread] else 0
            self.call(caller, thread)
            self.blocked[thread] = self.last_call
            self.events.append(CallBlocked(self.now, self.last_call, thread, caller, "/service"))

    def unblock(self, entity: EntityId, thread: ThreadId) -> None:
        """A call returns."""
        if thread in self.blocked:
            self.events.append(CallUnblocked(self.now, self.blocked.pop(thread), thread))

    def log(self, entity: EntityId, thread: ThreadId) -> None:
        """A line is written."""
        self.events.append(Logged(self.now, Severity.INFO, "node", f"at {self.now}", thread, entity))

    def move(self, entity: EntityId, thread: ThreadId) -> None:
        """The robot gets somewhere."""
        self.events.append(RobotMoved(self.now, 1.0, 2.0, 0.0, 3.0, 0.0, 0.0, True, False, 0.0, 0.0))


DOINGS = (
    System.message,
    System.message,
    System.message,
    System.start,
    System.start,
    System.end,
    System.suspend,
    System.resume,
    System.wait,
    System.stop_waiting,
    System.call,
    System.reply,
    System.block,
    System.unblock,
    System.expire,
    System.log,
    System.move,
)

_choices = st.tuples(
    st.integers(0, 4), st.sampled_from(DOINGS), st.sampled_from(list(GROUP_OF)), st.sampled_from(THREADS)
)


@st.composite
def legal_runs(draw: st.DrawFn) -> list[AnyEvent]:
    """Events of a run, in order of time, many of them at one time."""
    system = System()
    length = draw(st.integers(0, 60))
    for passed, doing, entity, thread in draw(st.lists(_choices, min_size=length, max_size=length)):
        system.now += passed
        doing(system, entity, thread)
    return system.events


@st.composite
def jumbled_runs(draw: st.DrawFn) -> tuple[list[AnyEvent], list[AnyEvent]]:
    """A legal run, and the same with neighbours swapped as threads that record at once may swap them.

    What one source records stays in order, and so does what bears one time.
    """
    events = draw(legal_runs())
    jumbled = list(events)
    for _ in range(3):
        swaps = draw(st.integers(0, 2 ** len(events) - 1))
        for place in range(len(events) - 1):
            first, second = jumbled[place : place + 2]
            apart = first.t != second.t and not _sources(first) & _sources(second)
            if apart and swaps >> place & 1:
                jumbled[place : place + 2] = [second, first]
    return events, jumbled


def _sources(event: AnyEvent) -> set[tuple[str, int]]:
    """What keeps an event in its place among others."""
    match event:
        case CallbackStarted() | CallbackEnded() | CallbackFailed():
            return {("thread", event.thread), ("callback", event.entity)}
        case CallbackSuspended() | CallbackResumed():
            return {("thread", event.thread), ("callback", event.entity)}
        case EntityReady() | MessageDropped():
            return {("queue", event.entity)}
        case WaitStarted() | WaitEnded():
            return {("wait", event.entity)}
        case ServiceCalled() | ServiceReplied():
            return {("call", event.call)}
        case CallBlocked() | CallUnblocked():
            return {("call", event.call), ("thread", event.thread)}
        case Published() | Scanned():
            return {(event.__class__.__name__, event.message)}
        case Logged():
            return {("thread", event.thread)}
        case _:
            return {("engine", 0)}
