"""Communication between nodes: messages, their contents, service calls and replies."""

from sim.trace.events.event import TraceEvent
from sim.trace.events.fields import (
    CallbackId,
    CallId,
    Cdr,
    Maybe,
    MessageId,
    Nanoseconds,
    NodeId,
    ServiceName,
    SourcePlace,
    ThreadId,
    TopicId,
    TopicName,
    TopicNames,
    TypeName,
    WireOnly,
)


class Published(TraceEvent, frozen=True, tag="publish"):
    """A message was published."""

    message: MessageId
    topic: TopicName
    node: NodeId
    entity: CallbackId


class QosMismatched(TraceEvent, frozen=True, tag="qos_mismatch"):
    """A publisher and a subscription of one topic do not match, so no messages pass between them.

    The node is the publisher's, the callback the subscription's, none for one outside the program. A
    subscription that no executor serves, as in ``wait_for_message``, is not an entity; its place is told
    instead.
    """

    topic: TopicName
    node: NodeId
    entity: CallbackId
    policy: str
    """Quality of service on which the two do not agree: ``RELIABILITY``, ``DURABILITY``, …; or ``TYPE``."""
    publisher: Maybe[SourcePlace] = ("", 0)
    """Where the program makes the publisher, as ``file:line``."""
    subscription: Maybe[SourcePlace] = ("", 0)
    """Where the program makes the subscription, as ``file:line``."""


class SynchroniserJudged(TraceEvent, frozen=True, tag="synchroniser"):
    """A synchroniser of ``message_filters`` has handed on none of many messages, or after that does.

    It is recorded at most three times for one synchroniser: while a topic has brought nothing, when all have,
    and once a set is handed on after all. The callback is the one in which that is noticed.
    """

    entity: CallbackId
    made_at: SourcePlace
    """Where the program makes the synchroniser, as ``file:line``."""
    topics: TopicNames
    """Topics whose messages it brings together; empty for one that is unknown."""
    messages: WireOnly[tuple[int, ...]]
    """How many messages of each topic came."""
    stamps: WireOnly[tuple[int, ...]]
    """Newest stamp of each topic, in nanoseconds; 0 also if it was not set."""
    slop: Nanoseconds
    """How far the stamps of a set may be apart, less than that; 0: they have to be equal."""
    apart: Nanoseconds
    """Least distance of a message of the rarest topic from the nearest of the others."""
    mostly: Nanoseconds
    """Distance that three of four messages of the rarest topic do not exceed."""
    matched: bool
    """Whether a set has been handed on."""


class TopicAppeared(TraceEvent, frozen=True, tag="topic"):
    """A topic whose contents are recorded had its first message published."""

    topic: WireOnly[TopicId]
    name: TopicName
    message_type: TypeName
    """Full name of the messages' type, such as ``std_msgs/msg/Int32``."""
    definition: str
    """Definition of the type and of all types in it, in the ``ros2msg`` form of MCAP schemas."""
    type_hash: WireOnly[str] = ""
    """Hash of the type in ROS 2 (``RIHS01_…``)."""
    offered_qos: WireOnly[str] = ""
    """Quality of service of the first publisher, as YAML in rosbag2's form."""


class MessageSent(TraceEvent, frozen=True, tag="message"):
    """A published message was encoded; only in runs whose contents are recorded."""

    message: MessageId
    topic: TopicId
    data: Cdr
    """The message as little-endian CDR; none if it could not be encoded."""


class ServiceCalled(TraceEvent, frozen=True, tag="service_call"):
    """A request left for a service."""

    call: CallId
    service: ServiceName
    entity: CallbackId
    request: str
    """The request, as Python shows it."""


class ServiceReplied(TraceEvent, frozen=True, tag="service_reply"):
    """A service answered a call."""

    call: CallId
    service: ServiceName
    response: str
    """The response, as Python shows it."""


class RequestLost(TraceEvent, frozen=True, tag="request_lost"):
    """A request was sent while no node offered the service; no reply will come."""

    call: CallId
    service: ServiceName


class CallBlocked(TraceEvent, frozen=True, tag="blocked"):
    """A thread blocks in ``Client.call`` until the reply comes."""

    call: CallId
    thread: ThreadId
    entity: CallbackId
    service: ServiceName


class CallUnblocked(TraceEvent, frozen=True, tag="unblocked"):
    """``Client.call`` returned."""

    call: CallId
    thread: ThreadId
