"""Every event that a run can put on its trace; the one vocabulary that engine, files and screen share.

Times are integer nanoseconds since the run began. Ids are small integers, unique within a run and kind;
an id is introduced by an ``…Appeared`` event before any other event uses it. Events are tiny because a
callback writes several of them: on the wire each is a MessagePack array that starts with its tag.
"""

from enum import StrEnum
from typing import Any, TypeAlias

import msgspec

ThreadId: TypeAlias = int
NodeId: TypeAlias = int
GroupId: TypeAlias = int
EntityId: TypeAlias = int
ExecutorId: TypeAlias = int
MessageId: TypeAlias = int
CallId: TypeAlias = int
ProcessId: TypeAlias = int
LineId: TypeAlias = int
TopicId: TypeAlias = int


class EntityKind(StrEnum):
    """What an entity of a wait set is."""

    TIMER = "timer"
    SUBSCRIPTION = "subscription"
    GUARD = "guard"
    CLIENT = "client"
    SERVICE = "service"
    WAITABLE = "waitable"


class GroupKind(StrEnum):
    """How a callback group admits callbacks."""

    EXCLUSIVE = "exclusive"
    REENTRANT = "reentrant"
    CUSTOM = "custom"


class Reason(StrEnum):
    """Why a ready callback does not run."""

    GROUP_HELD = "group held"
    """Its mutually exclusive group has let another callback in."""
    NO_FREE_WORKER = "no free worker"
    """Its group would let it in, but every thread of its executor is running a callback."""
    NOBODY_SPINS = "nobody spins"
    """Its node is in no executor, or that executor is not spinning."""


class Severity(StrEnum):
    """Severities of a log line, named as ROS prints them."""

    DEBUG = "DEBUG"
    INFO = "INFO"
    WARN = "WARN"
    ERROR = "ERROR"
    FATAL = "FATAL"


class Reading(StrEnum):
    """How a program takes what is typed at its terminal."""

    NOTHING = "nothing"
    """It does not wait for the keyboard any more."""
    LINES = "lines"
    """Line by line; each key is shown as it is typed, and ctrl+c ends the run."""
    SECRET = "secret"
    """Line by line, and nothing is shown: a password."""
    KEYS = "keys"
    """Key by key, without enter; ctrl+c ends the run."""
    RAW = "raw"
    """Key by key, and ctrl+c is a key like any other."""

    @property
    def takes_keys(self) -> bool:
        """Whether it takes each key as it is typed."""
        return self in (Reading.KEYS, Reading.RAW)


class Event(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """Something that happened in a run, at ``t`` nanoseconds after its beginning."""

    t: int


class RunStarted(Event, frozen=True, tag="run_start"):
    """The run began; ``epoch`` (nanoseconds since 1970) plus ``t`` is the stamp that log lines show."""

    target: str
    clock: str
    epoch: int


class RunEnded(Event, frozen=True, tag="run_end"):
    """The run is over: its time was up, its program returned or failed, or somebody stopped it."""

    reason: str
    failed: bool


class RunEnding(Event, frozen=True, tag="run_ending"):
    """The program was told to end, as by Ctrl-C: what follows is its own ending, and checks leave it out."""

    reason: str


class ProcessAppeared(Event, frozen=True, tag="process"):
    """One of several programs of the run was started; ``label`` tells it from the others."""

    process: ProcessId
    label: str


class ProcessEnded(Event, frozen=True, tag="process_end"):
    """One of several programs ended: ``reason`` is a sentence, ``status`` its exit code."""

    process: ProcessId
    reason: str
    status: int


class ThreadAppeared(Event, frozen=True, tag="thread"):
    """A thread of a learner's program ran its first callback or was named by its executor.

    ``name`` is as the lanes show it; ``process`` is 0 where the run has one program only; ``executor`` is the
    one whose worker the thread is, 0 for a thread that the program itself started.
    """

    thread: ThreadId
    name: str
    process: ProcessId = 0
    executor: ExecutorId = 0


class ExecutorAppeared(Event, frozen=True, tag="executor"):
    """An executor was made; ``threads`` is how many callbacks it can run at once."""

    executor: ExecutorId
    kind: str
    threads: int


class NodeAppeared(Event, frozen=True, tag="node"):
    """A node of the learner's program was made; ``name`` is fully qualified (``/sub_node``)."""

    node: NodeId
    name: str


class GroupAppeared(Event, frozen=True, tag="group"):
    """A callback group got its first entity; ``class_name`` is the Python class of the group."""

    group: GroupId
    node: NodeId
    kind: GroupKind
    class_name: str


class EntityAppeared(Event, frozen=True, tag="entity"):
    """An entity with a callback was made.

    ``name`` is the topic or service (or empty), ``callback`` the function's name, ``file`` and the line
    range where it is written. ``depth`` is the QoS depth (0 for timers), ``period`` in nanoseconds (0 for
    others than timers).
    """

    entity: EntityId
    node: NodeId
    group: GroupId
    kind: EntityKind
    name: str
    callback: str
    file: str
    first_line: int
    last_line: int
    depth: int
    period: int


class EntityGone(Event, frozen=True, tag="entity_gone"):
    """An entity was destroyed."""

    entity: EntityId


class EntityReady(Event, frozen=True, tag="ready"):
    """A message, request or reply arrived (or a timer fell due); ``depth`` now wait in its queue."""

    entity: EntityId
    depth: int
    message: MessageId


class MessageDropped(Event, frozen=True, tag="message_drop"):
    """A queue lost ``message``; ``depth`` stay.

    A full queue loses its oldest message to a newer one, and any queue what stays longer than the lifespan
    that its publisher gave it.
    """

    entity: EntityId
    depth: int
    message: MessageId


class WaitStarted(Event, frozen=True, tag="wait_start"):
    """A callback has been ready since ``since`` and does not run, for ``reason``.

    ``holder`` is the entity whose callback is in the way (0: none). Another ``WaitStarted`` of the same
    entity replaces the reason. ``workers_busy`` tells that no thread was free either.
    """

    entity: EntityId
    since: int
    reason: Reason
    holder: EntityId
    workers_busy: bool


class WaitEnded(Event, frozen=True, tag="wait_end"):
    """A callback that waited got its thread, or what it waited for is gone."""

    entity: EntityId


class CallbackStarted(Event, frozen=True, tag="callback_start"):
    """A thread began to run an entity's callback.

    Recorded on that thread, after the group let it in and the message was taken, before the callback's
    first line. ``age`` is nanoseconds since the message was published, or how late a timer is.
    ``depth`` is what is left in the queue.
    """

    entity: EntityId
    thread: ThreadId
    message: MessageId
    age: int
    depth: int


class CallbackEnded(Event, frozen=True, tag="callback_end"):
    """The callback returned or raised, and its group is free of it."""

    entity: EntityId
    thread: ThreadId


class CallbackSuspended(Event, frozen=True, tag="callback_suspend"):
    """A coroutine callback awaits something; its thread is free, its group still held."""

    entity: EntityId
    thread: ThreadId


class CallbackResumed(Event, frozen=True, tag="callback_resume"):
    """A suspended coroutine callback runs on, perhaps on another thread."""

    entity: EntityId
    thread: ThreadId


class SpinClashed(Event, frozen=True, tag="spin_clash"):
    """A thread asked to spin what is being spun already.

    ``entity`` is the callback that asked (0: none) and ``function`` what it called of rclpy's, in ``file`` at
    ``line`` of the learner's code. ``node`` was taken from the executor that spins it, which serves it no
    more; 0: nothing was taken, and the executor, which spins already, raised ``RuntimeError``.
    """

    entity: EntityId
    node: NodeId
    function: str
    file: str
    line: int


class CallbackFailed(Event, frozen=True, tag="callback_error"):
    """A callback raised; ``file`` and ``line`` are the innermost ones of the learner's own code."""

    entity: EntityId
    thread: ThreadId
    error: str
    file: str
    line: int


class Published(Event, frozen=True, tag="publish"):
    """A message was published; ``entity`` is the callback that did it (0: none), ``node`` 0 for the robot."""

    message: MessageId
    topic: str
    node: NodeId
    entity: EntityId


class QosMismatched(Event, frozen=True, tag="qos_mismatch"):
    """A publisher and a subscription of one topic do not match, so no message goes between them.

    ``node`` is the publisher's (0: one outside the program), ``entity`` the subscription (0: one outside),
    ``policy`` the quality of service that the two do not agree on, as ROS names it. ``publisher`` and
    ``subscription`` are where the program makes the two, ``("", 0)`` for one that it does not make; a
    subscription that no executor serves, as ``wait_for_message`` makes it, is no entity and has a place.
    """

    topic: str
    node: NodeId
    entity: EntityId
    policy: str
    publisher: tuple[str, int] = ("", 0)
    subscription: tuple[str, int] = ("", 0)


class TopicAppeared(Event, frozen=True, tag="topic"):
    """The first message of a topic was published of which the trace is to have the contents.

    ``message_type`` is a full name (``std_msgs/msg/Int32``), ``definition`` its text with all that it
    contains, in the ``ros2msg`` form of MCAP schemas, ``type_hash`` what ROS 2 knows the type by
    (``RIHS01_…``), ``offered_qos`` what the first publisher offers, as YAML in rosbag2's form.
    """

    topic: TopicId
    name: str
    message_type: str
    definition: str
    type_hash: str = ""
    offered_qos: str = ""


class MessageSent(Event, frozen=True, tag="message"):
    """What a published message holds, as little-endian CDR; None where it could not be encoded.

    Only in runs that are set up to keep contents.
    """

    message: MessageId
    topic: TopicId
    data: bytes | None


class ServiceCalled(Event, frozen=True, tag="service_call"):
    """A request left for a service; ``entity`` is the calling callback (0: none or from outside)."""

    call: CallId
    service: str
    entity: EntityId
    request: str


class ServiceReplied(Event, frozen=True, tag="service_reply"):
    """The service's answer to a call."""

    call: CallId
    service: str
    response: str


class RequestLost(Event, frozen=True, tag="request_lost"):
    """A request was sent while nobody offered the service; no answer will ever come."""

    call: CallId
    service: str


class CallBlocked(Event, frozen=True, tag="blocked"):
    """A thread stands still in ``Client.call`` until the reply comes; ``entity`` is the callback it runs."""

    call: CallId
    thread: ThreadId
    entity: EntityId
    service: str


class CallUnblocked(Event, frozen=True, tag="unblocked"):
    """``Client.call`` returned."""

    call: CallId
    thread: ThreadId


class Logged(Event, frozen=True, tag="log"):
    """A log line of the learner's program; ``entity`` is the callback that wrote it (0: none)."""

    severity: Severity
    logger: str
    text: str
    thread: ThreadId
    entity: EntityId


class Printed(Event, frozen=True, tag="print"):
    """Text that a program wrote to standard output or error, one line at a time.

    ``ends`` is False for the beginning of a line behind which the program waits for the keyboard.
    """

    text: str
    error: bool
    process: ProcessId = 0
    ends: bool = True


class ArenaShown(Event, frozen=True, tag="arena"):
    """What stands around the robot, in metres: walls as (x0, y0, x1, y1), the sphere as (x, y, radius)."""

    walls: tuple[tuple[float, float, float, float], ...]
    sphere: tuple[float, float, float]
    robot_radius: float


class RobotMoved(Event, frozen=True, tag="robot"):
    """Where the robot is: metres, radians; ``front`` is the true range straight ahead (inf: nothing).

    ``linear`` (m/s) and ``angular`` (rad/s) are its real velocities, ``turned`` (radians, signed) and
    ``travelled`` (metres) count from the run's beginning.
    """

    x: float
    y: float
    yaw: float
    front: float
    linear: float
    angular: float
    motors: bool
    touching: bool
    turned: float
    travelled: float


class Scanned(Event, frozen=True, tag="scan"):
    """The laser's ranges over a full turn: little-endian uint16 millimetres, 0 for nothing in range.

    Beam i points at -pi + i·2pi/n from straight ahead, counter-clockwise. ``message`` is the message that
    carried it.
    """

    message: MessageId
    ranges: bytes


class VelocityCommanded(Event, frozen=True, tag="cmd_vel"):
    """The robot's driver took a velocity command, in m/s and rad/s, after clamping."""

    linear: float
    angular: float


class CommandGiven(Event, frozen=True, tag="command"):
    """The person at the keyboard or the command line did something to the run, such as calling a service."""

    text: str


class InputGiven(Event, frozen=True, tag="input"):
    """Something was told to the run from outside, and is carried out now: what a repetition has to be told.

    ``command`` is a command of the engine as JSON. What the set-up of the run foresaw is not among these, nor
    is what is done to the run's time. ``recess`` is 0 at the end of its moment; a moment that does not end
    takes inputs in recesses, which are counted from 1.
    """

    command: str
    recess: int = 0


class TimeHalted(Event, frozen=True, tag="halt"):
    """Time stands again: what the run was to go on to has come; ``text`` is the command that said so."""

    text: str


class TimePassed(Event, frozen=True, tag="time"):
    """The run on the real clock has come to ``t``: told while nothing else is, so that time goes on."""


class KeyboardAsked(Event, frozen=True, tag="keyboard"):
    """A program waits for the keyboard; recorded where it begins to, does so in another way, or stops.

    A program that looks for keys again and again, each time for a moment, is recorded the first time only.
    ``program`` is what people call it.
    """

    reads: Reading
    program: str


class Typed(Event, frozen=True, tag="typed"):
    """Text was typed at the terminal of the run's programs; a password is spelt in dots."""

    text: str


class LineGiven(Event, frozen=True, tag="line"):
    """A ``ros2`` line was given, at the prompt, on the command line or by the run's set-up."""

    line: LineId
    text: str


class LineSaid(Event, frozen=True, tag="line_text"):
    """A line of text that a ``ros2`` line wrote to standard output, or to standard error."""

    line: LineId
    text: str
    error: bool


class LineEnded(Event, frozen=True, tag="line_end"):
    """A ``ros2`` line is done; ``status`` is its exit code."""

    line: LineId
    status: int


class LineCompleted(Event, frozen=True, tag="completion"):
    """What could stand in a ``ros2`` line from ``start`` to where completion was asked for."""

    line: LineId
    start: int
    words: tuple[str, ...]


class Notice(Event, frozen=True, tag="notice"):
    """The engine has something to say to the person about the run itself, in one sentence.

    ``entity`` is the callback that waits without an end, where that is what there is to say; 0: none.
    ``unrepeatable``: it says why a run on virtual time cannot be repeated exactly.
    """

    severity: Severity
    text: str
    entity: EntityId = 0
    unrepeatable: bool = False


class EventsLost(Event, frozen=True, tag="lost"):
    """The trace could not keep up: ``count`` events in all have been thrown away so far."""

    count: int


class ContentsLost(Event, frozen=True, tag="contents_lost"):
    """Messages were published faster than they could be encoded: ``count`` in all are without contents."""

    count: int


AnyEvent: TypeAlias = (
    RunStarted
    | RunEnded
    | RunEnding
    | ProcessAppeared
    | ProcessEnded
    | ThreadAppeared
    | ExecutorAppeared
    | NodeAppeared
    | GroupAppeared
    | EntityAppeared
    | EntityGone
    | EntityReady
    | MessageDropped
    | WaitStarted
    | WaitEnded
    | CallbackStarted
    | CallbackEnded
    | CallbackSuspended
    | CallbackResumed
    | SpinClashed
    | CallbackFailed
    | Published
    | QosMismatched
    | TopicAppeared
    | MessageSent
    | ServiceCalled
    | ServiceReplied
    | RequestLost
    | CallBlocked
    | CallUnblocked
    | Logged
    | Printed
    | ArenaShown
    | RobotMoved
    | Scanned
    | VelocityCommanded
    | CommandGiven
    | InputGiven
    | TimeHalted
    | TimePassed
    | KeyboardAsked
    | Typed
    | LineGiven
    | LineSaid
    | LineEnded
    | LineCompleted
    | Notice
    | EventsLost
    | ContentsLost
)

_encoder = msgspec.msgpack.Encoder()
_decoder = msgspec.msgpack.Decoder(list[AnyEvent])


def encode(events: list[AnyEvent]) -> bytes:
    """Pack a batch of events for the pipe or a file."""
    try:
        return _encoder.encode(events)
    except UnicodeEncodeError:
        return _encoder.encode(spelt_out(events))


def spelt_out(events: list[AnyEvent]) -> list[AnyEvent]:
    """Return events in whose texts lone surrogates, which no encoding has, are written as ``\\udc80``.

    They come from names of files that are not UTF-8, and what programs say can hold them.
    """
    return [_spelt_out(event) for event in events]


def _spelt_out(value: Any) -> Any:
    match value:
        case str():
            return value.encode(errors="backslashreplace").decode()
        case tuple():
            return tuple(map(_spelt_out, value))
        case msgspec.Struct():
            texts = {name: _spelt_out(getattr(value, name)) for name in value.__struct_fields__}
            return msgspec.structs.replace(value, **texts)
    return value


def decode(batch: bytes) -> list[AnyEvent]:
    """Unpack what ``encode`` packed.

    Raises:
        msgspec.DecodeError: the bytes are no batch of events.
    """
    try:
        return _decoder.decode(batch)
    except (UnicodeDecodeError, RecursionError) as error:
        raise msgspec.DecodeError(f"the bytes are no events: {error}") from None
