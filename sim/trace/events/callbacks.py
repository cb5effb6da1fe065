"""The life of a callback: ready, waiting, running, suspended, failed, ended."""

from enum import StrEnum

from sim.trace.events.event import TraceEvent
from sim.trace.events.fields import (
    EntityId,
    Frames,
    HolderId,
    LockHolderId,
    LockKeeperId,
    Maybe,
    MessageId,
    Nanoseconds,
    ProcessId,
    SourcePlace,
    Text,
    ThreadId,
    ThreadName,
    WireOnly,
)


class Reason(StrEnum):
    """Why a ready callback does not run."""

    GROUP_HELD = "group held"
    """Its mutually exclusive group has let another callback in."""
    NO_FREE_WORKER = "no free worker"
    """Its group would let it in, but every thread of its executor is running a callback."""
    EVENT_QUEUE = "behind others in the event queue"
    """Its EventsExecutor, which asks no group, is running an earlier event."""
    NOBODY_SPINS = "nobody spins"
    """Its node is in no executor, or that executor is not spinning."""


class EntityReady(TraceEvent, frozen=True, tag="ready"):
    """A message, request or reply arrived, or a timer fell due."""

    entity: EntityId
    depth: int
    """Messages in the queue after it."""
    message: Maybe[MessageId]


class TimerCancelled(TraceEvent, frozen=True, tag="timer_cancel"):
    """A timer was cancelled: it falls due no more, until it is reset."""

    entity: EntityId


class TimerReset(TraceEvent, frozen=True, tag="timer_reset"):
    """A cancelled timer was reset: it falls due again one period later."""

    entity: EntityId


class MessageDropped(TraceEvent, frozen=True, tag="message_drop"):
    """A queue lost a message.

    A full queue loses its oldest message to a newer one; any queue loses a message that stays longer than the
    lifespan set by its publisher.
    """

    entity: EntityId
    depth: int
    """Messages in the queue after it."""
    message: Maybe[MessageId]


class WaitStarted(TraceEvent, frozen=True, tag="wait_start"):
    """A ready callback does not run.

    Another ``wait_start`` of the same entity replaces the reason.
    """

    entity: EntityId
    since: Nanoseconds
    """When the callback became ready; the same for all events of one wait."""
    reason: Reason
    """Why it waits: ``group held``, ``no free worker``, ``behind others in the event queue`` or
    ``nobody spins``."""
    holder: HolderId
    """Name of the callback that is in the way."""
    workers_busy: bool
    """Whether no thread was free either."""


class WaitEnded(TraceEvent, frozen=True, tag="wait_end"):
    """A waiting callback got its thread, or what it waited for has gone."""

    entity: EntityId


class CallbackStarted(TraceEvent, frozen=True, tag="callback_start"):
    """A thread began to run an entity's callback.

    Recorded on that thread, after the group let it in and the message was taken, before the callback's
    first line.
    """

    entity: EntityId
    thread: ThreadId
    message: Maybe[MessageId]
    age: Nanoseconds
    """Time since the message was published, or how late a timer is."""
    depth: int
    """Messages left in the queue."""


class CallbackEnded(TraceEvent, frozen=True, tag="callback_end"):
    """The callback returned or raised, and left its group."""

    entity: EntityId
    thread: ThreadId


class CallbackSuspended(TraceEvent, frozen=True, tag="callback_suspend"):
    """A coroutine callback awaits something; its thread is free, its group still held."""

    entity: EntityId
    thread: ThreadId
    frames: Maybe[Frames] = ()
    """The lines of the program's own at which it awaits, from the callback inwards."""


class CallbackResumed(TraceEvent, frozen=True, tag="callback_resume"):
    """A suspended coroutine callback continues, perhaps on another thread."""

    entity: EntityId
    thread: ThreadId


class Doing(StrEnum):
    """What a running callback does at its line."""

    COMPUTES = "computes"
    SLEEPS = "sleeps"
    WAITS = "waits"
    """For another thread: a lock, an event, a thread's end, an item of a queue."""
    CALLS_ROS = "in rclpy"
    """It is in a function of rclpy, such as ``Client.call``."""
    READS = "reads"
    """It waits for input from the keyboard."""


class CallbackAt(TraceEvent, frozen=True, tag="callback_at"):
    """Where a running callback is in the program's own code; another one replaces it.

    On virtual time it is recorded as time passes, so that it is exact; on the real clock threads are sampled.
    """

    entity: EntityId
    thread: ThreadId
    doing: Doing
    """``computes``, ``sleeps``, ``waits`` for another thread, ``in rclpy``, or ``reads`` the keyboard."""
    call: Maybe[str]
    """The function in which it sleeps or waits, such as ``Client.call``."""
    frames: Frames
    """The lines of the program's own on its stack, from the callback inwards."""
    loop: Maybe[SourcePlace] = ("", 0)
    """The ``while`` around the innermost of them that has one."""
    holder: LockHolderId = 0
    """Name of the thread whose callback has the lock that it waits for, or whose end or job it waits for."""
    until: Maybe[Nanoseconds] = 0
    """When the timeout of its wait is over, of the first of several at one line; none if it waits without
    one, or sleeps."""
    keeper: LockKeeperId = 0
    """Entity whose callback took the lock that it waits for, in a call that is suspended or over."""
    lock: Maybe[str] = ""
    """The name by which the line knows the lock that it waits for, such as ``self.lock``."""
    taken_at: Maybe[SourcePlace] = ("", 0)
    """Where that lock was taken."""
    taken_by: Maybe[str] = ""
    """Name of the thread that took it, if no callback of which the executor knows did."""
    is_left: WireOnly[bool] = False
    """Whether that thread has ended without a release."""


class ProgramAt(TraceEvent, frozen=True, tag="program_at"):
    """Where a program's main thread is while it spins nothing, or spins inside ``__init__``.

    Another one replaces it. It is looked for a few times a second.
    """

    doing: Doing
    """As in ``callback_at``."""
    call: Maybe[str]
    """The function in which it sleeps or waits, such as ``Client.wait_for_service``."""
    frames: Frames
    """The lines of the program's own on its stack; none once it spins as it should."""
    loop: Maybe[SourcePlace] = ("", 0)
    """The ``while`` around the innermost of them that has one."""
    until: Maybe[Nanoseconds] = 0
    """As in ``callback_at``."""
    process: Maybe[ProcessId] = 0
    """Which of several programs it is."""

    @property
    def place(self) -> tuple[str, int]:
        """File and line of the innermost frame, or of the loop around it."""
        file, _, line = self.frames[-1]
        return self.loop if self.loop[0] else (file, line)


class OwnThreadAt(TraceEvent, frozen=True, tag="own_thread_at"):
    """Where a thread that the program itself started waits or sleeps, outside callbacks.

    Another one of the same number replaces it. It is looked for a few times a second, on a few threads.
    """

    number: WireOnly[int]
    """Which of the threads that are looked at it is; that of an ended one is used again."""
    name: ThreadName
    doing: Doing
    """As in ``callback_at``."""
    call: Maybe[str]
    """As in ``callback_at``."""
    frames: Frames
    """As in ``callback_at``; none once it goes on or has ended."""
    lock: Maybe[str] = ""
    """As in ``callback_at``."""


class CallbackFailed(TraceEvent, frozen=True, tag="callback_error"):
    """A callback raised."""

    entity: EntityId
    thread: ThreadId
    error: Text
    """The exception's class and text."""
    file: str
    """Innermost file of the program's own code."""
    line: int
    """Line in that file."""
    exception: WireOnly[str] = ""
    """The exception's class; "" if not known."""
    no_response: WireOnly[bool] = False
    """Whether a service's callback returned without a response."""


class ExceptionSurfaced(TraceEvent, frozen=True, tag="exception_surfaced"):
    """A MultiThreadedExecutor raised, out of the function that spins it, what a callback had raised."""

    thread: ThreadId
    """Thread that spins."""
    error: Text
    """The exception's class and text."""
    file: str
    """As in ``callback_error``."""
    line: int
    """As in ``callback_error``."""
