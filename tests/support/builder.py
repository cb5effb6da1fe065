"""Writes runs by hand for tests: a builder of legal event sequences, times in seconds.

Calls may come in any order; queues (depths, drops, which message a callback takes and how old it is) are
worked out when ``events`` is asked for.
"""

import copy
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from sim.trace.events import (
    AnyEvent,
    ArenaShown,
    CallbackEnded,
    CallbackFailed,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    CallBlocked,
    CallId,
    CallUnblocked,
    CommandGiven,
    EntityAppeared,
    EntityGone,
    EntityId,
    EntityKind,
    EntityReady,
    EventsLost,
    ExecutorAppeared,
    ExecutorId,
    Frames,
    GroupAppeared,
    GroupId,
    GroupKind,
    Logged,
    MessageDropped,
    MessageId,
    NodeAppeared,
    NodeId,
    Notice,
    Printed,
    Published,
    Reason,
    RobotMoved,
    RunEnded,
    RunStarted,
    Scanned,
    ServiceCalled,
    ServiceReplied,
    Severity,
    ThreadAppeared,
    ThreadId,
    VelocityCommanded,
    WaitEnded,
    WaitStarted,
)

EPOCH = 1_631_462_000_000_000_000


def ns(seconds: float) -> int:
    """Nanoseconds of so many seconds."""
    return round(seconds * 1e9)


@dataclass(slots=True)
class _Belt:
    """The queue of one entity while the events are worked out."""

    size: int
    waiting: deque[tuple[MessageId, int]] = field(default_factory=deque)


_Step = Callable[[dict[EntityId, _Belt]], list[AnyEvent]]


class Run:
    """A run under construction. Times are seconds; ids are given out from 1, as the engine does."""

    def __init__(self, target: str = "shared-group", clock: str = "virtual") -> None:
        self._steps: list[tuple[int, int, _Step]] = []
        self._sizes: dict[EntityId, int] = {}
        self._nodes: dict[GroupId, NodeId] = {}
        self._names: dict[EntityId, str] = {}
        self._given: dict[str, int] = {}
        self._events: list[AnyEvent] | None = None
        self.add(RunStarted(0, target, clock, EPOCH))

    # the cast

    def thread(self, name: str, at: float = 0.0) -> ThreadId:
        """Name a thread; one named as a pool's is a worker of the first executor."""
        thread = self._next("thread")
        executor = 1 if name.startswith("ThreadPoolExecutor") else 0
        self.add(ThreadAppeared(ns(at), thread, name, executor=executor))
        return thread

    def executor(self, kind: str, threads: int, at: float = 0.0) -> ExecutorId:
        """Make an executor; ``kind`` is its class name."""
        executor = self._next("executor")
        self.add(ExecutorAppeared(ns(at), executor, kind, threads))
        return executor

    def node(self, name: str) -> NodeId:
        """Make a node, fully qualified."""
        node = self._next("node")
        self.add(NodeAppeared(0, node, name))
        return node

    def exclusive(self, node: NodeId) -> GroupId:
        """Make a mutually exclusive group."""
        return self._group(node, GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup")

    def reentrant(self, node: NodeId) -> GroupId:
        """Make a reentrant group."""
        return self._group(node, GroupKind.REENTRANT, "ReentrantCallbackGroup")

    def task(self, node: NodeId, callback: str) -> EntityId:
        """Make what stands for a function that an executor runs as a task."""
        group = self._group(node, GroupKind.NONE, "NoGroup")
        return self._entity(group, EntityKind.TASK, "", callback, "node.py", (1, 1), 0, 0)

    def timer(
        self,
        group: GroupId,
        callback: str,
        period: float,
        file: str = "node.py",
        lines: tuple[int, int] = (1, 1),
    ) -> EntityId:
        """Make a timer."""
        return self._entity(group, EntityKind.TIMER, "", callback, file, lines, 0, ns(period))

    def subscription(
        self,
        group: GroupId,
        topic: str,
        callback: str,
        depth: int = 10,
        file: str = "node.py",
        lines: tuple[int, int] = (1, 1),
    ) -> EntityId:
        """Make a subscription."""
        return self._entity(group, EntityKind.SUBSCRIPTION, topic, callback, file, lines, depth, 0)

    def service(
        self,
        group: GroupId,
        name: str,
        callback: str,
        depth: int = 10,
        file: str = "node.py",
        lines: tuple[int, int] = (1, 1),
        interface_type: str = "std_srvs/srv/SetBool",
    ) -> EntityId:
        """Make a service."""
        return self._entity(group, EntityKind.SERVICE, name, callback, file, lines, depth, 0, interface_type)

    def client(self, group: GroupId, name: str, callback: str = "", depth: int = 10) -> EntityId:
        """Make a client."""
        return self._entity(group, EntityKind.CLIENT, name, callback, "node.py", (1, 1), depth, 0)

    def gone(self, entity: EntityId, at: float) -> None:
        """Destroy an entity."""
        self.add(EntityGone(ns(at), entity))

    # what arrives, waits and runs

    def message(self, entity: EntityId, at: float, delay: float = 0.0) -> MessageId:
        """Let a message arrive that was published ``delay`` before; a full queue loses its oldest."""
        message = self._next("message")
        self.add(Published(ns(at - delay), message, self._names[entity], 0, 0))
        self._arrive(entity, message, ns(at), ns(at - delay))
        return message

    def request(self, entity: EntityId, at: float) -> MessageId:
        """Let a request or reply arrive in the entity's queue."""
        message = self._next("message")
        self._arrive(entity, message, ns(at), ns(at))
        return message

    def due(self, timer: EntityId, at: float) -> None:
        """Let a timer fall due."""
        self.add(EntityReady(ns(at), timer, 0, 0))

    def wait(
        self,
        entity: EntityId,
        since: float,
        until: float | None = None,
        reason: Reason = Reason.GROUP_HELD,
        holder: EntityId = 0,
        workers_busy: bool = False,
    ) -> None:
        """Let a ready callback wait; without ``until`` it waits to the end."""
        self.add(WaitStarted(ns(since), entity, ns(since), reason, holder, workers_busy))
        if until is not None:
            self.add(WaitEnded(ns(until), entity))

    def wait_changes(
        self,
        entity: EntityId,
        at: float,
        since: float,
        reason: Reason,
        holder: EntityId = 0,
        workers_busy: bool = False,
    ) -> None:
        """Give a wait that began at ``since`` a new reason."""
        self.add(WaitStarted(ns(at), entity, ns(since), reason, holder, workers_busy))

    def callback(
        self,
        entity: EntityId,
        thread: ThreadId,
        at: float,
        for_: float | None = None,
        late: float = 0.0,
    ) -> None:
        """Run a callback ``for_`` seconds (None: it never ends); it takes the oldest message, if any waits.

        ``late`` is the age for a callback that takes no message: how late a timer is.
        """
        self.start(entity, thread, at, late)
        if for_ is not None:
            self.end(entity, thread, at + for_)

    def start(self, entity: EntityId, thread: ThreadId, at: float, late: float = 0.0) -> None:
        """Begin a callback."""
        t = ns(at)

        def step(belts: dict[EntityId, _Belt]) -> list[AnyEvent]:
            waiting = belts[entity].waiting
            message, born = waiting.popleft() if waiting else (0, t - ns(late))
            return [CallbackStarted(t, entity, thread, message, t - born, len(waiting))]

        self._plan(t, step)

    def end(self, entity: EntityId, thread: ThreadId, at: float) -> None:
        """End a callback."""
        self.add(CallbackEnded(ns(at), entity, thread))

    def suspend(self, entity: EntityId, thread: ThreadId, at: float, frames: Frames = ()) -> None:
        """Let a coroutine callback await something, at these lines."""
        self.add(CallbackSuspended(ns(at), entity, thread, frames))

    def resume(self, entity: EntityId, thread: ThreadId, at: float) -> None:
        """Let a suspended callback run on."""
        self.add(CallbackResumed(ns(at), entity, thread))

    def fail(self, entity: EntityId, thread: ThreadId, at: float, error: str, line: int = 1) -> None:
        """Raise in a callback, and end it."""
        self.add(CallbackFailed(ns(at), entity, thread, error, "node.py", line))
        self.end(entity, thread, at)

    # calls

    def call(
        self,
        service: str,
        at: float,
        replied: float | None = None,
        request: str = "SetBool_Request(data=True)",
        response: str = "SetBool_Response(success=True, message='')",
        entity: EntityId = 0,
    ) -> CallId:
        """Call a service; without ``replied`` the reply stays out."""
        call = self._next("call")
        self.add(ServiceCalled(ns(at), call, service, entity, request))
        if replied is not None:
            self.add(ServiceReplied(ns(replied), call, service, response))
        return call

    def blocked(
        self,
        call: CallId,
        service: str,
        thread: ThreadId,
        entity: EntityId,
        at: float,
        until: float | None = None,
    ) -> None:
        """Let a thread stand still in ``Client.call``."""
        self.add(CallBlocked(ns(at), call, thread, entity, service))
        if until is not None:
            self.add(CallUnblocked(ns(until), call, thread))

    # what is said

    def log(
        self,
        text: str,
        at: float,
        thread: ThreadId = 0,
        entity: EntityId = 0,
        severity: Severity = Severity.INFO,
        logger: str = "sub_node",
    ) -> None:
        """Write a log line."""
        self.add(Logged(ns(at), severity, logger, text, thread, entity))

    def printed(self, text: str, at: float, error: bool = False) -> None:
        """Write to standard output or error."""
        self.add(Printed(ns(at), text, error))

    def command(self, text: str, at: float) -> None:
        """Let the person do something to the run."""
        self.add(CommandGiven(ns(at), text))

    def notice(self, text: str, at: float, severity: Severity = Severity.WARN) -> None:
        """Let the engine say something."""
        self.add(Notice(ns(at), severity, text))

    def lost(self, count: int, at: float) -> None:
        """Let the trace lose events, ``count`` in all."""
        self.add(EventsLost(ns(at), count))

    def over(self, at: float, reason: str = "its time was up", failed: bool = False) -> None:
        """End the run."""
        self.add(RunEnded(ns(at), reason, failed, time_was_up=reason == "its time was up"))

    # the robot

    def robot(
        self,
        at: float,
        x: float = 0.0,
        y: float = 0.0,
        yaw: float = 0.0,
        front: float = float("inf"),
        linear: float = 0.0,
        angular: float = 0.0,
        motors: bool = True,
        touching: bool = False,
        turned: float = 0.0,
        travelled: float = 0.0,
    ) -> None:
        """Put the robot somewhere."""
        self.add(
            RobotMoved(ns(at), x, y, yaw, front, linear, angular, motors, touching, turned, travelled),
        )

    def arena(self, wall: float, sphere: tuple[float, float, float]) -> None:
        """Put walls ``wall`` metres off on every side, and a sphere."""
        corners = ((-wall, -wall), (wall, -wall), (wall, wall), (-wall, wall))
        walls = tuple((*corners[place - 1], *corner) for place, corner in enumerate(corners))
        self.add(ArenaShown(0, walls, sphere, 0.105))

    def scan(self, message: MessageId, at: float, ranges: bytes) -> None:
        """Measure a turn of the laser, carried by ``message``."""
        self.add(Scanned(ns(at), message, ranges))

    def velocity(self, at: float, linear: float, angular: float) -> None:
        """Command a velocity."""
        self.add(VelocityCommanded(ns(at), linear, angular))

    # the outcome

    def add(self, event: AnyEvent) -> None:
        """Put any event into the run."""
        self._plan(event.t, lambda _: [event])

    def stop(self, at: float) -> None:
        """Forget what was planned after ``at``, and end the run there."""
        self._steps = [step for step in self._steps if step[0] <= ns(at)]
        self.over(at)

    def copy(self) -> "Run":
        """The same run as it is now; what is planned for one from now on is not in the other."""
        other = copy.copy(self)
        other._events = self.events
        other._steps = list(self._steps)
        other._sizes, other._nodes = dict(self._sizes), dict(self._nodes)
        other._names, other._given = dict(self._names), dict(self._given)
        return other

    @property
    def events(self) -> list[AnyEvent]:
        """Every event in order of time; of one time, in the order they were written."""
        if self._events is None:
            belts = {entity: _Belt(size) for entity, size in self._sizes.items()}
            steps = sorted(self._steps, key=lambda step: step[:2])
            self._events = [event for _, _, step in steps for event in step(belts)]
        return list(self._events)

    def until(self, at: float) -> list[AnyEvent]:
        """The events up to and including ``at``: the run as it is known live at that moment."""
        return [event for event in self.events if event.t <= ns(at)]

    def _plan(self, t: int, step: _Step) -> None:
        self._events = None
        self._steps.append((t, len(self._steps), step))

    def _next(self, what: str) -> int:
        self._given[what] = self._given.get(what, 0) + 1
        return self._given[what]

    def _group(self, node: NodeId, kind: GroupKind, class_name: str) -> GroupId:
        group = self._next("group")
        self._nodes[group] = node
        self.add(GroupAppeared(0, group, node, kind, class_name))
        return group

    def _entity(
        self,
        group: GroupId,
        kind: EntityKind,
        name: str,
        callback: str,
        file: str,
        lines: tuple[int, int],
        depth: int,
        period: int,
        interface_type: str = "",
    ) -> EntityId:
        entity = self._next("entity")
        self._sizes[entity] = depth
        self._names[entity] = name
        node = self._nodes[group]
        about = (kind, name, callback, file, *lines, depth, period, interface_type)
        self.add(EntityAppeared(0, entity, node, group, *about))
        return entity

    def _arrive(self, entity: EntityId, message: MessageId, t: int, born: int) -> None:
        def step(belts: dict[EntityId, _Belt]) -> list[AnyEvent]:
            belt = belts[entity]
            belt.waiting.append((message, born))
            if len(belt.waiting) <= belt.size:
                return [EntityReady(t, entity, len(belt.waiting), message)]
            lost, _ = belt.waiting.popleft()
            return [
                MessageDropped(t, entity, belt.size, lost),
                EntityReady(t, entity, belt.size, message),
            ]

        self._plan(t, step)
