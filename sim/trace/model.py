"""The values that a timeline returns: participants, calls, waits, queues and moments."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum, StrEnum
from typing import TypeAlias

from sim.trace.events import (
    CallId,
    Doing,
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
    """An interval of time, ``start`` inclusive to ``end`` exclusive, in nanoseconds."""

    start: Nanoseconds
    end: Nanoseconds

    @property
    def length(self) -> Nanoseconds:
        """Nanoseconds from start to end."""
        return self.end - self.start


@dataclass(frozen=True, slots=True)
class ThreadInfo:
    """A thread, named as in rclpy; ``process`` is its program's, if there are several.

    ``executor`` is the one whose worker it is, 0 for a thread that the program started.
    """

    id: ThreadId
    name: str
    since: Nanoseconds
    process: ProcessId = 0
    executor: ExecutorId = 0


@dataclass(frozen=True, slots=True)
class ExecutorInfo:
    """An executor and how many callbacks it can run at once."""

    id: ExecutorId
    kind: str
    threads: int
    is_nested: bool
    """Whether a callback made it, such as a nested ``rclpy.spin_until_future_complete``."""


@dataclass(frozen=True, slots=True)
class GroupInfo:
    """A callback group; letters (A, B, …, Z, A2, …) are assigned in order of appearance."""

    id: GroupId
    node: NodeId
    kind: GroupKind
    class_name: str
    place: int
    is_own: bool = True
    """Whether the program made it; else a change to the run did."""

    @property
    def is_open(self) -> bool:
        """Whether it admits every callback: it is reentrant, or stands for no group."""
        return self.kind in (GroupKind.REENTRANT, GroupKind.NONE)

    @property
    def letter(self) -> str:
        """Its letter by its place, from 0: A, B, … Z, A2, B2, …"""
        turn, within = divmod(self.place, 26)
        return chr(ord("A") + within) + (str(turn + 1) if turn else "")


@dataclass(frozen=True, slots=True)
class EntityInfo:
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
    interface_type: str = ""
    made_at: tuple[str, int] = ("", 0)
    """File and line of the program's own that made it; empty for none."""
    first_due: Nanoseconds | None = None
    """When a timer falls due first, unless it is cancelled; None if unknown, as on a simulated clock."""

    @property
    def label(self) -> str:
        """A short name: the last part of its topic or service, else its callback; a goal's callback."""
        by_callback = self.callback if self.kind is EntityKind.WAITABLE else ""
        return by_callback or self.name.rsplit("/", 1)[-1] or self.function

    @property
    def function(self) -> str:
        """Its callback; of a lambda with the line, as it has no name: ``<lambda>:12``."""
        line = f":{self.first_line}" if self.callback == _LAMBDA and self.first_line else ""
        return f"{self.callback}{line}"

    @property
    def spoken_name(self) -> str:
        """Its name in sentences and tables: its function, else the topic, service or action, else the kind.

        A function whose name says nothing gives way to these; that of a message filter is ``callback``.
        A client is named after the reply that it takes, so that it is not mistaken for the service.
        """
        if self.kind is EntityKind.CLIENT and self.name and not self.callback:
            return f"reply of {self.name}"
        named = "" if self.callback in ("callback", _LAMBDA) else self.callback
        return named or self.name or self.function or self.kind.value


_LAMBDA = "<lambda>"


class Lasting:
    """Something that lasts until ``end``, which is None while it does."""

    __slots__ = ()
    end: Nanoseconds | None

    def end_at(self, now: Nanoseconds) -> Nanoseconds:
        """The end; ``now`` while it lasts."""
        return now if self.end is None else self.end


@dataclass(slots=True)
class Span(Lasting):
    """One call of a callback on a thread; ``end`` is None while it runs."""

    start: Nanoseconds
    end: Nanoseconds | None
    entity: EntityId
    thread: ThreadId
    message: MessageId
    age: Nanoseconds
    error: str = ""
    """Class and text of the exception that it raised; "" for none."""
    exception: str = ""
    """The class of that exception; "" if not known."""
    no_response: bool = False
    """Whether that exception stands for a service's callback that returned no response."""
    raised_at: tuple[str, int] = ("", 0)
    """The innermost file and line of the program's own that raised it."""
    number: int = field(default=-1, compare=False)
    """Its place among the spans of the run, in the order in which they were begun."""
    first: int = field(default=-1, compare=False)
    """The number of the span with which its call began: its own, unless it was resumed; -1 if not known."""


@dataclass(slots=True)
class Wait(Lasting):
    """An interval in which a ready callback did not run, for one reason; ``end`` is None while it lasts.

    ``since`` is when the callback became ready: a series of waits with changing reasons has one ``since``.
    """

    start: Nanoseconds
    end: Nanoseconds | None
    since: Nanoseconds
    entity: EntityId
    reason: Reason
    holder: EntityId
    workers_busy: bool

    @property
    def is_for_own_call(self) -> bool:
        """Whether its own last call keeps it waiting, and not just for a thread, as in a reentrant group."""
        return self.holder == self.entity and self.reason is not Reason.NO_FREE_WORKER


@dataclass(slots=True)
class Blocked(Lasting):
    """An interval in which ``Client.call`` blocked a thread; ``end`` is None while it lasts.

    ``entity`` is the calling callback (0: none), ``service`` the one that was called.
    """

    start: Nanoseconds
    end: Nanoseconds | None
    thread: ThreadId
    entity: EntityId
    call: CallId
    service: str


@dataclass(frozen=True, slots=True)
class Frame:
    """A line of the program's own on a thread's stack."""

    file: str
    function: str
    line: int


WAITING = (Doing.WAITS, Doing.CALLS_ROS, Doing.READS)
"""What a line does that waits for something else than time."""
RESULT = "Future.result"
"""The function in which a position waits for the result of a pool's job."""
AWAIT = "await"
"""What a position has in place of a function while its call is suspended."""


@dataclass(frozen=True, slots=True)
class Position(Lasting):
    """An interval in which a callback was at one line; ``end`` is None while it is there.

    ``frames`` lead from the callback to that line; ``call`` is the function in which it sleeps or waits, ""
    for none; ``loop`` is the file and line of the ``while`` around it, ("", 0) for none. A suspended call is
    at its ``await``, on no thread: ``thread`` is 0.
    """

    start: Nanoseconds
    end: Nanoseconds | None
    thread: ThreadId
    entity: EntityId
    doing: Doing
    call: str
    frames: tuple[Frame, ...]
    loop: tuple[str, int] = ("", 0)
    holder: ThreadId = 0
    """The thread whose callback has the lock that it waits for, or whose end or job it waits for; 0: none."""
    keeper: EntityId = 0
    """The callback that took that lock in a call that is suspended or over; 0 for none."""
    lock: str = ""
    """The name by which its line knows that lock, such as ``self.lock``; "" if it is not known."""
    taken_at: tuple[str, int] = ("", 0)
    """File and line where that lock was taken; ("", 0) if it is not known."""
    taken_by: str = ""
    """The thread that took it, if no callback is known to; "" for none."""
    is_left: bool = False
    """Whether that thread has ended without a release."""
    until: Nanoseconds = 0
    """When the timeout of its wait is over; 0 if it has none, or does not wait."""

    @property
    def waits(self) -> bool:
        """Whether it waits: for another thread, for the keyboard, or in a function of rclpy."""
        return self.doing in WAITING

    @property
    def waits_for_lock(self) -> bool:
        """Whether it waits for a lock."""
        return self.doing is Doing.WAITS and self.call == "Lock.acquire"

    @property
    def file(self) -> str:
        """The file of the innermost line."""
        return self.frames[-1].file

    @property
    def line(self) -> int:
        """The innermost line."""
        return self.frames[-1].line


class Deed(Enum):
    """What was done with a call of a callback, or to a queue."""

    BEGUN = 0
    RESUMED = 1
    SUSPENDED = 2
    ENDED = 3
    BLOCKED = 4
    UNBLOCKED = 5
    LOST = 6


@dataclass(frozen=True, slots=True)
class Publication:
    """The publication of a message: its node (0: the robot) and callback (0: none)."""

    at: Nanoseconds
    node: NodeId
    entity: EntityId


@dataclass(frozen=True, slots=True)
class Sending:
    """A message of a topic, or a request of a service, and the call that sent it (None: no callback's).

    Of two calls of one callback that run at the same time the one that began later is taken to be the sender.
    """

    at: Nanoseconds
    id: MessageId | CallId
    sender: Span | None


@dataclass(frozen=True, slots=True)
class QueuedMessage:
    """An item of a queue: a message of a topic, or the request or reply of a call."""

    id: MessageId | CallId
    since: Nanoseconds
    """When it was published or sent; if that is unknown, when it arrived."""
    arrived: Nanoseconds
    """When it was queued."""

    def age(self, at: Nanoseconds) -> Nanoseconds:
        """Its age at ``at``."""
        return at - self.since


@dataclass(frozen=True, slots=True)
class Queue:
    """A queue at one moment: the number of queued messages and of those lost so far.

    ``messages`` are the queued ones, the next one first; fewer than ``depth`` if the trace lost events.
    """

    depth: int
    dropped: int
    messages: Sequence[QueuedMessage] = ()

    @property
    def oldest(self) -> Nanoseconds | None:
        """The origin time of the next message; None for an empty queue."""
        return self.messages[0].since if self.messages else None

    @property
    def next_arrived(self) -> Nanoseconds | None:
        """When the next message was queued; None for an empty queue."""
        return self.messages[0].arrived if self.messages else None


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


class AxisMarkKind(StrEnum):
    """What happened at a point on the time axis."""

    COMMAND = "command"
    CALL = "call"
    REPLY = "reply"
    NOTICE = "notice"
    ERROR = "error"


@dataclass(frozen=True, slots=True)
class AxisMark:
    """A point on the time axis."""

    at: Nanoseconds
    kind: AxisMarkKind
    text: str


@dataclass(frozen=True, slots=True)
class Moment:
    """The state of a run at ``at``: running and waiting callbacks, queues, pending calls."""

    at: Nanoseconds
    running: Mapping[ThreadId, Span] = field(default_factory=dict)
    waiting: Mapping[EntityId, Wait] = field(default_factory=dict)
    blocked: Mapping[ThreadId, Blocked] = field(default_factory=dict)
    queues: Mapping[EntityId, Queue] = field(default_factory=dict)
    holders: Mapping[GroupId, tuple[EntityId, ...]] = field(default_factory=dict)
    pending_calls: tuple[Call, ...] = ()
