"""What a timeline knows about a run: participants, what ran, what waited, and one moment of it all."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from sim.trace.events import (
    CallId,
    EntityId,
    EntityKind,
    ExecutorId,
    GroupId,
    GroupKind,
    MessageId,
    NodeId,
    ProcessId,
    Reason,
    ThreadId,
)

Nanoseconds: TypeAlias = int


@dataclass(frozen=True, slots=True)
class Window:
    """A stretch of time, ``start`` inclusive to ``end`` exclusive, in nanoseconds."""

    start: Nanoseconds
    end: Nanoseconds

    @property
    def length(self) -> Nanoseconds:
        """Nanoseconds from start to end."""
        return self.end - self.start


@dataclass(frozen=True, slots=True)
class Thread:
    """A thread, named as rclpy names it; ``process`` is its program's, of several.

    ``executor`` is the one whose worker it is, 0 for one that the program itself started.
    """

    id: ThreadId
    name: str
    since: Nanoseconds
    process: ProcessId = 0
    executor: ExecutorId = 0


@dataclass(frozen=True, slots=True)
class Executor:
    """An executor and how many callbacks it can run at once."""

    id: ExecutorId
    kind: str
    threads: int


@dataclass(frozen=True, slots=True)
class Group:
    """A callback group; ``letter`` (A, B, …, Z, A2, …) is given in order of appearance."""

    id: GroupId
    node: NodeId
    kind: GroupKind
    class_name: str
    letter: str


@dataclass(frozen=True, slots=True)
class Entity:
    """Something with a callback: a timer, subscription, service, client, guard condition or waitable."""

    id: EntityId
    node: NodeId
    group: GroupId
    kind: EntityKind
    name: str
    callback: str
    file: str
    first_line: int
    last_line: int
    depth: int
    period: Nanoseconds

    @property
    def label(self) -> str:
        """The shortest name a person would call it by: its topic or service, else its callback."""
        return self.name.rsplit("/", 1)[-1] or self.callback

    @property
    def spoken_name(self) -> str:
        """The function a person wrote, else the topic, service or action, else what kind of thing it is.

        What a client waits to take is a reply: by its service's name alone it would be taken for the service.
        """
        if self.kind is EntityKind.CLIENT and self.name and not self.callback:
            return f"reply of {self.name}"
        return self.callback or self.name or self.kind.value


@dataclass(slots=True)
class Span:
    """One call of a callback on a thread; ``end`` is None while it runs."""

    start: Nanoseconds
    end: Nanoseconds | None
    entity: EntityId
    thread: ThreadId
    message: MessageId
    age: Nanoseconds
    error: str = ""

    def end_at(self, now: Nanoseconds) -> Nanoseconds:
        """The end, or ``now`` for a call that still runs."""
        return now if self.end is None else self.end


@dataclass(slots=True)
class Wait:
    """A stretch in which a ready callback did not run, for one reason; ``end`` is None while it lasts.

    ``since`` is when the callback became ready: waits that follow each other for changing reasons share it.
    """

    start: Nanoseconds
    end: Nanoseconds | None
    since: Nanoseconds
    entity: EntityId
    reason: Reason
    holder: EntityId
    workers_busy: bool


@dataclass(slots=True)
class Blocked:
    """A stretch in which a thread stood still in ``Client.call``; ``end`` is None while it does.

    ``entity`` is the callback that called (0: none), ``service`` the one that is to answer ``call``.
    """

    start: Nanoseconds
    end: Nanoseconds | None
    thread: ThreadId
    entity: EntityId
    call: CallId
    service: str


@dataclass(frozen=True, slots=True)
class Publication:
    """How a message was published: by which node (0: the robot) and in which callback (0: none)."""

    at: Nanoseconds
    node: NodeId
    entity: EntityId


@dataclass(frozen=True, slots=True)
class QueuedMessage:
    """What waits in a queue: a message of a topic, or the request or reply of a call."""

    id: MessageId | CallId
    since: Nanoseconds
    """When it was published or sent, or when it arrived if that is not known."""

    def age(self, at: Nanoseconds) -> Nanoseconds:
        """How old it was at ``at``."""
        return at - self.since


@dataclass(frozen=True, slots=True)
class Queue:
    """A queue at one moment: how many messages wait and how many the run has lost there so far.

    ``messages`` are those that wait, the next one first; fewer than ``depth`` where the trace lost some.
    """

    depth: int
    dropped: int
    messages: Sequence[QueuedMessage] = ()

    @property
    def oldest(self) -> Nanoseconds | None:
        """Since when the message that is next is under way; None for an empty queue."""
        return self.messages[0].since if self.messages else None


@dataclass(slots=True)
class Call:
    """A service call; the reply is None while it is outstanding. ``lost``: nobody offered the service."""

    id: CallId
    service: str
    caller: EntityId
    request: str
    sent: Nanoseconds
    replied: Nanoseconds | None = None
    response: str = ""
    lost: bool = False


@dataclass(frozen=True, slots=True)
class AxisMark:
    """A point in time worth a sign on the axis: a command given, a call, a reply, a notice."""

    at: Nanoseconds
    kind: str
    text: str


@dataclass(frozen=True, slots=True)
class Moment:
    """All that a screen shows of one instant ``at``: who runs, who waits and why, what is queued.

    ``log_position`` is how many log lines had been written.
    """

    at: Nanoseconds
    running: Mapping[ThreadId, Span] = field(default_factory=dict)
    waiting: Mapping[EntityId, Wait] = field(default_factory=dict)
    blocked: Mapping[ThreadId, Blocked] = field(default_factory=dict)
    queues: Mapping[EntityId, Queue] = field(default_factory=dict)
    holders: Mapping[GroupId, tuple[EntityId, ...]] = field(default_factory=dict)
    pending_calls: tuple[Call, ...] = ()
    log_position: int = 0
