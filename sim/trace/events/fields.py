"""The types of events' fields: their meaning, their units, and their form in lines of JSON.

On the wire times are integer nanoseconds. Ids are small integers, unique within a run and kind; an
``…Appeared`` event introduces an id before any other event uses it. In JSON times are seconds, and names
stand for ids. The text below a type is its text in ``EVENTS.md``.
"""

from collections.abc import Callable
from enum import Enum
from typing import Annotated, Any, NamedTuple, Protocol, TypeAlias, TypeVar

T = TypeVar("T")

JsonObject: TypeAlias = dict[str, object]
"""The fields of a line of JSON, by their names."""


class IdNames(Protocol):
    """Names of a run's ids, as far as its events have introduced them; None or nothing for an unknown one."""

    def process(self, process: int) -> str | None:
        """The label of one of several programs."""

    def node(self, node: int) -> str:
        """The name of a node."""

    def thread(self, thread: int) -> str:
        """The name of a thread."""

    def topic(self, topic: int) -> str:
        """The name of a topic whose contents are recorded."""

    def callback(self, entity: int) -> str | None:
        """The spoken name of an entity."""

    def entity(self, entity: int) -> JsonObject:
        """The fields of an entity."""

    def group(self, group: int) -> JsonObject:
        """The fields of a callback group."""


class JsonForm(NamedTuple):
    """The form of an event's field in a line of JSON.

    ``names`` are the fields of the line, separated by spaces; empty: one with the field's own name. A name
    with ``?`` is left out of some lines. ``look_up`` or ``convert`` returns the value, None to leave it out;
    for several names it returns a dictionary of those that apply. ``unit`` is the unit in JSON.
    """

    names: str = ""
    look_up: Callable[[IdNames, Any], object] | None = None
    convert: Callable[[Any], object] | None = None
    unit: str = ""


class Shown(Enum):
    """Which lines of JSON have a field; without a mark, every line has it."""

    IF_ANY = "if any"
    NEVER = "never"


Maybe: TypeAlias = Annotated[T, Shown.IF_ANY]
"""A field of which 0 or an empty text means none: the line of JSON leaves it out."""

WireOnly: TypeAlias = Annotated[T, Shown.NEVER]
"""A field that lines of JSON leave out: other fields have it, or only cbtui uses it."""


def _seconds(nanoseconds: int) -> float:
    return nanoseconds / 1e9


def _size(data: bytes | None) -> int | None:
    return None if data is None else len(data)


def _scan(ranges: bytes) -> JsonObject:
    """Keep only the range straight ahead: all of them would exceed the rest of the file."""
    beams = len(ranges) // 2
    ahead = int.from_bytes(ranges[beams : beams + 2], "little")
    return {"beams": beams, "front": ahead / 1000 if ahead else None}


def _place(place: tuple[str, int]) -> str | None:
    file, line = place
    return f"{file}:{line}" if file else None


def _frames(frames: tuple[tuple[str, str, int], ...]) -> list[str]:
    return [f"{file}:{line}, in {function}" for file, function, line in frames]


# Units.

Nanoseconds: TypeAlias = Annotated[int, JsonForm(convert=_seconds, unit="s")]
Metres: TypeAlias = Annotated[float, JsonForm(unit="m")]
Radians: TypeAlias = Annotated[float, JsonForm(unit="rad")]
MetresPerSecond: TypeAlias = Annotated[float, JsonForm(unit="m/s")]
RadiansPerSecond: TypeAlias = Annotated[float, JsonForm(unit="rad/s")]

# Ids.

ProcessId: TypeAlias = Annotated[int, JsonForm("process", lambda names, number: names.process(number))]
"""Label of one of several programs of the run, such as ``talker-1``."""

NodeId: TypeAlias = Annotated[int, JsonForm("node", lambda names, number: names.node(number))]
"""Fully qualified name of the node, ``robot`` for the robot's driver; in ``log``, the logger's name."""

CallbackId: TypeAlias = Annotated[
    int, JsonForm("callback", lambda names, number: names.callback(number)), Shown.IF_ANY
]
"""Name of the callback in which it happened, or of the callback concerned."""

EntityId: TypeAlias = Annotated[
    int, JsonForm("node callback? kind entity group group_type", lambda names, number: names.entity(number))
]
"""The entity: its node, its callback's function, its ``kind`` (``timer``, ``subscription``, ``guard``,
``client``, ``service`` or ``waitable``), its topic or service, or its callback where it has neither, and its
callback group."""

HolderId: TypeAlias = Annotated[
    int, JsonForm("held_by", lambda names, number: names.callback(number)), Shown.IF_ANY
]

LockHolderId: TypeAlias = Annotated[
    int, JsonForm("held_by", lambda names, number: names.thread(number)), Shown.IF_ANY
]

LockKeeperId: TypeAlias = Annotated[
    int, JsonForm("kept_by", lambda names, number: names.callback(number)), Shown.IF_ANY
]

GroupId: TypeAlias = Annotated[int, JsonForm("group group_type", lambda names, number: names.group(number))]
"""Letter of the callback group (A, B, … Z, A2, …), and its type: ``exclusive``, ``reentrant``, ``custom``
for a class of the program's own, or ``no group`` for what an executor runs in none."""

ThreadId: TypeAlias = Annotated[int, JsonForm("thread", lambda names, number: names.thread(number))]
"""Name of the thread."""

ExecutorId: TypeAlias = int

TopicId: TypeAlias = Annotated[int, JsonForm("entity", lambda names, number: names.topic(number))]

MessageId: TypeAlias = Annotated[int, JsonForm("message_id")]
"""Number of the message, the same where it is published, arrives, is taken or is dropped."""

CallId: TypeAlias = Annotated[int, JsonForm("call")]
"""Number of the service call."""

LineId: TypeAlias = Annotated[int, JsonForm("line")]
"""Number of the ``ros2`` line."""

# Names and texts.

TopicName: TypeAlias = Annotated[str, JsonForm("entity")]
"""Name of the topic or service."""

TopicNames: TypeAlias = Annotated[tuple[str, ...], JsonForm("topics", convert=list)]
"""Names of topics."""

AttributeNames: TypeAlias = Annotated[tuple[str, ...], JsonForm("attributes", convert=list)]
"""Names of attributes of the node."""

ServiceName: TypeAlias = Annotated[str, JsonForm("entity")]

LoggerName: TypeAlias = Annotated[str, JsonForm("node")]

ThreadName: TypeAlias = Annotated[str, JsonForm("thread")]

Text: TypeAlias = Annotated[str, JsonForm("message")]

TypeName: TypeAlias = Annotated[str, JsonForm("type")]

SourcePlace: TypeAlias = Annotated[tuple[str, int], JsonForm(convert=_place)]

Frames: TypeAlias = Annotated[tuple[tuple[str, str, int], ...], JsonForm(convert=_frames)]

# Contents.

Cdr: TypeAlias = Annotated[bytes | None, JsonForm("size?", convert=_size)]

Ranges: TypeAlias = Annotated[bytes, JsonForm("beams front", convert=_scan)]
