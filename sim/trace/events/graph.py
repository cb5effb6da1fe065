"""The participants of a run: programs, threads, executors, nodes, callback groups and entities."""

from enum import StrEnum

from sim.trace.events.event import TraceEvent
from sim.trace.events.fields import (
    AttributeNames,
    CallbackId,
    EntityId,
    ExecutorId,
    GroupId,
    Maybe,
    Nanoseconds,
    NodeId,
    ProcessId,
    SourcePlace,
    ThreadId,
    ThreadName,
    TypeName,
    WireOnly,
)


class EntityKind(StrEnum):
    """The kind of an entity of a wait set."""

    TIMER = "timer"
    SUBSCRIPTION = "subscription"
    GUARD = "guard"
    CLIENT = "client"
    SERVICE = "service"
    WAITABLE = "waitable"
    TASK = "task"
    """A function that an executor runs in no callback group, such as a done-callback."""


class GroupKind(StrEnum):
    """How a callback group admits callbacks."""

    EXCLUSIVE = "exclusive"
    REENTRANT = "reentrant"
    CUSTOM = "custom"
    NONE = "no group"
    """Stands on the trace for the group of what an executor runs in none."""


class ProcessAppeared(TraceEvent, frozen=True, tag="process"):
    """One of several programs of the run was started."""

    process: ProcessId
    label: WireOnly[str]
    """Distinguishes the program from the others."""


class ProcessEnded(TraceEvent, frozen=True, tag="process_end"):
    """One of several programs ended."""

    process: ProcessId
    reason: str
    """Why the program ended, as a sentence."""
    status: int
    """Exit code."""


class ThreadAppeared(TraceEvent, frozen=True, tag="thread"):
    """A thread of a program ran its first callback, or its executor named it."""

    thread: WireOnly[ThreadId]
    name: ThreadName
    """Name as the lanes show it, among several programs without its program's label."""
    process: Maybe[ProcessId] = 0
    executor: WireOnly[ExecutorId] = 0
    """The executor whose worker the thread is; 0 for a thread that the program itself started."""


class ExecutorAppeared(TraceEvent, frozen=True, tag="executor"):
    """An executor was made."""

    executor: WireOnly[ExecutorId]
    kind: str
    """Class of the executor."""
    threads: int
    """How many callbacks it can run at once."""


class NodeAppeared(TraceEvent, frozen=True, tag="node"):
    """A node of a program was made."""

    node: NodeId
    name: WireOnly[str]
    """Fully qualified name (``/sub_node``)."""


class GroupAppeared(TraceEvent, frozen=True, tag="group"):
    """A callback group got its first entity."""

    group: GroupId
    node: NodeId
    kind: WireOnly[GroupKind]
    class_name: str
    """Python class of the group."""
    is_own: WireOnly[bool] = True
    """Whether the program made it; else a change to the run did, such as a cure."""


class EntityAppeared(TraceEvent, frozen=True, tag="entity"):
    """An entity with a callback was made."""

    entity: EntityId
    node: WireOnly[NodeId]
    group: WireOnly[GroupId]
    kind: WireOnly[EntityKind]
    name: WireOnly[str]
    """Topic or service; of an action, ``/fetch server`` or ``/fetch client``; empty where there is none."""
    callback: WireOnly[str]
    """Name of the callback's function."""
    file: str
    """File in which the callback is written."""
    first_line: int
    """First line of the callback."""
    last_line: int
    """Last line of the callback."""
    depth: int
    """QoS depth of the queue; 0 for timers."""
    period: Nanoseconds
    """Time between a timer's calls; 0 for others."""
    interface_type: Maybe[TypeName] = ""
    """Type of the topic or service (``std_srvs/srv/SetBool``); empty where there is neither."""
    made_at: Maybe[SourcePlace] = ("", 0)
    """Where the program makes it, as ``file:line``."""


class EntityGone(TraceEvent, frozen=True, tag="entity_gone"):
    """An entity was destroyed."""

    entity: EntityId


class TimesKept(TraceEvent, frozen=True, tag="times_kept"):
    """A node still holds times of its simulated clock, half a second after it was set back."""

    node: NodeId
    length: Nanoseconds
    """How far the clock was set back."""
    attributes: AttributeNames


class SpinClashed(TraceEvent, frozen=True, tag="spin_clash"):
    """A thread asked to spin an executor or a node that already spins.

    Without ``node`` no node was taken from an executor.
    """

    entity: CallbackId
    node: Maybe[NodeId]
    """Node that was taken from the executor that spins it; that executor serves it no longer."""
    function: str
    """The function of rclpy that asked to spin."""
    file: Maybe[str]
    """File of the program in which it was called."""
    line: Maybe[int]
    """Line at which it was called."""
    endless: WireOnly[bool] = False
    """Whether it was called without a timeout."""
    refused: WireOnly[bool] = True
    """Without ``node``: whether the executor raised ``RuntimeError``; rclpy before Jazzy 7.1.9 does not."""
