"""Reads a recording: the readable part of a damaged or truncated one, with a sentence on what is missing."""

import stat
import struct
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Header, Metadata, Schema

from sim.recording import batch
from sim.recording.chunk import ChunkError, records_in, unpack_chunk, unpacked_most
from sim.recording.container import Container, Record
from sim.recording.metadata import NAME, RecordingMetadata, from_metadata
from sim.recording.recorder import EVENTS_CHANNEL, LIBRARY
from sim.trace.events import AnyEvent, RunStarted

ReadableT = TypeVar("ReadableT", Attachment, Channel, Header, Metadata, Schema)
_RawMessage: TypeAlias = tuple[int, bytes, int, int]
"""A message: id of its channel, content of its chunk, start and end in it."""

_MESSAGE = struct.Struct("<HIQQ")
"""Header of a message: channel, sequence number, times of recording and publication."""
_CHECKSUM = struct.Struct("<I")
_LONGEST = 64_000_000
"""Bytes of a metadata record or an attachment at most; longer ones are skipped."""


class RecordingError(Exception):
    """The file cannot be read as a recording; the text is a sentence that says why."""


@dataclass(frozen=True)
class Topic:
    """A topic of a recording: its name, the full name of its messages' type, and how many there are."""

    name: str
    type: str
    definition: str
    count: int


@dataclass(frozen=True)
class RecordedMessage:
    """A message of a topic, as CDR; ``published`` is nanoseconds since 1970."""

    topic: str
    type: str
    published: int
    data: bytes


def read(path: Path) -> "Recording":
    """Open a recording: its outline is read at once, the rest on demand.

    Raises:
        RecordingError: it is not a recording, nothing in it is readable, or a later version wrote it.
    """
    try:
        if stat.S_ISFIFO(path.stat().st_mode):
            raise RecordingError(f"{path} is a pipe, and a recording is read back and forth; give a file")
        recording = Recording(path)
        recording.check()
    except OSError as error:
        raise RecordingError(f"{path} cannot be read: {error.strerror}") from None
    return recording


class Recording:
    """The recording of a run in a file, made by ``read``. Every method may raise OSError.

    Not thread-safe.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.about = RecordingMetadata()
        self.sources: dict[str, str] = {}
        """The source files of the programs, by path."""
        self._library = ""
        self._participants: list[AnyEvent] = []
        self.share = 0.0
        """How much of the file the latest iteration has read, from 0 to 1."""
        self._chunks: list[Record] = []
        self._damaged: set[int] = set()
        self._unpacked_too_much = False
        self._channels: dict[int, Channel] = {}
        self._schemas: dict[int, Schema] = {}
        self._counts: Counter[int] | None = None
        with path.open("rb") as file:
            container = Container(file)
            for record in container.records():
                self._outline(container, record)
        self._size = container.size
        self._gaps = container.gaps
        self._complete = container.complete
        self._indexed = container.indexed

    def _outline(self, container: Container, record: Record) -> None:
        """Note a chunk, and parse the small records."""
        if record.opcode == Opcode.CHUNK:
            self._chunks.append(record)
        elif record.opcode in _OUTLINED and record.length <= _LONGEST:
            content = container.read(record)
            try:
                self._read_outline(record.opcode, content)
            except _UNREADABLE:
                self._damaged.add(record.offset)

    def _read_outline(self, opcode: int, content: bytes) -> None:
        match opcode:
            case Opcode.HEADER:
                self._library = _parsed(Header, content).library
            case Opcode.SCHEMA | Opcode.CHANNEL:
                self._introduce(opcode, content)
            case Opcode.METADATA:
                metadata = _parsed(Metadata, content)
                if metadata.name == NAME:
                    about = from_metadata(metadata.metadata)
                    if about is None:
                        raise ValueError("no metadata of a recording")
                    self.about = about
            case Opcode.ATTACHMENT:
                attachment = _parsed(Attachment, content)
                if _CHECKSUM.unpack(content[-4:]) != (zlib.crc32(content[:-4]),):
                    raise ValueError("its checksum is wrong")
                if attachment.media_type == batch.PARTICIPANTS:
                    self._participants = batch.unpack_batch(attachment.data)
                else:
                    self.sources[attachment.name] = attachment.data.decode()

    def _introduce(self, opcode: int, content: bytes) -> None:
        """Add a schema or channel; the first of an id counts, since a later one may be damaged."""
        if opcode == Opcode.SCHEMA:
            schema = _parsed(Schema, content)
            self._schemas.setdefault(schema.id, schema)
        else:
            channel = _parsed(Channel, content)
            self._channels.setdefault(channel.id, channel)

    def check(self) -> None:
        """Check that the file is a recording and something in it is readable.

        Raises:
            RecordingError: it is not.
        """
        if self._size == 0:
            raise RecordingError(f"{self.path} is empty")
        if not (self._chunks or self._library):
            raise RecordingError(f"{self.path} is not a recording: it has nothing of an MCAP file in it")
        first = next(self.batches(), None)
        if first is None and not (self._library.startswith(LIBRARY) or self.about.title):
            raise RecordingError(
                f"{self.path} is an MCAP file, but not a recording of cbtui: nothing is on {batch.TOPIC}"
            )

    # contents

    def batches(self) -> Iterator[list[AnyEvent]]:
        """The events as they were recorded, batch by batch.

        If the beginning is damaged, the known participants come first.

        Raises:
            RecordingError: a later version of cbtui wrote them.
        """
        begun = False
        for channel, content, start, end in self._messages():
            if self._is_events(channel):
                try:
                    events = batch.unpack_batch(content[start + _MESSAGE.size : end])
                except batch.BatchError:
                    self._damaged.add(start)
                    continue
                except batch.NewerFormatError as error:
                    raise RecordingError(
                        f"{self.path} is in {error}, and this cbtui knows formats up to {batch.FORMAT}; "
                        "use the version that recorded it, or a later one"
                    ) from None
                if not begun:
                    begun = True
                    yield from self._lost_beginning(events)
                yield events

    def _lost_beginning(self, events: list[AnyEvent]) -> Iterator[list[AnyEvent]]:
        """The participants from before the first readable events, unless these are from the run's start."""
        if events and not any(isinstance(event, RunStarted) for event in events):
            known = [event for event in self._participants if event.t <= events[0].t and event not in events]
            if known:
                yield known

    def messages(self) -> Iterator[RecordedMessage]:
        """The messages of all topics, in the order of recording."""
        for number, content, start, end in self._messages():
            channel = self._channels.get(number)
            if channel is not None and not self._is_events(number):
                _, _, _, published = _MESSAGE.unpack_from(content, start)
                data = content[start + _MESSAGE.size : end]
                yield RecordedMessage(channel.topic, self._type_of(channel), published, data)

    def topics(self) -> list[Topic]:
        """The topics in the order of their first messages, without the channel of events."""
        if self._counts is None:
            for _ in self._messages():
                pass
        counts = self._counts or Counter()
        return [
            Topic(channel.topic, self._type_of(channel), self._definition_of(channel), counts[number])
            for number, channel in sorted(self._channels.items())
            if not self._is_events(number)
        ]

    def _type_of(self, channel: Channel) -> str:
        schema = self._schemas.get(channel.schema_id)
        return "" if schema is None else schema.name

    def _definition_of(self, channel: Channel) -> str:
        schema = self._schemas.get(channel.schema_id)
        return "" if schema is None else schema.data.decode(errors="replace")

    def _is_events(self, channel: int) -> bool:
        known = self._channels.get(channel)
        # The chunk with the first channel may be damaged.
        return known.topic == batch.TOPIC if known else channel == EVENTS_CHANNEL

    def _messages(self) -> Iterator[_RawMessage]:
        """Every message of every intact chunk; counts them at the end."""
        counts: Counter[int] = Counter()
        room = unpacked_most(self._size)
        with self.path.open("rb") as file:
            container = Container(file)
            for chunk in self._chunks:
                self.share = chunk.offset / self._size
                try:
                    content = unpack_chunk(container.read(chunk))
                    if len(content) > room:
                        self._unpacked_too_much = True
                        break
                    for message in self._messages_in(content):
                        counts[message[0]] += 1
                        yield message
                    room -= len(content)
                except (ChunkError, *_UNREADABLE):
                    self._damaged.add(chunk.offset)
        self._counts = counts

    def _messages_in(self, content: bytes) -> Iterator[_RawMessage]:
        for opcode, start, end in records_in(content):
            if opcode == Opcode.MESSAGE:
                channel, _, _, _ = _MESSAGE.unpack_from(content, start)
                yield channel, content, start, end
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                self._introduce(opcode, content[start:end])

    # damage

    @property
    def damage(self) -> str | None:
        """One sentence on what cannot be read; None if nothing is missing.

        The outline is known at once, the contents once they have been read to their end.
        """
        troubles = []
        parts = len(self._gaps) + len(self._damaged)
        if parts:
            first = min([*self._gaps, *self._damaged])
            troubles.append(f"{_parts(parts)} damaged, the first at byte {first:,}, and left out")
        if self._unpacked_too_much:
            troubles.append(
                f"it unpacks to more than {unpacked_most(self._size) // 1_000_000:,} MB, which no recording "
                "of its size does, and the rest is left out"
            )
        if not self._complete:
            troubles.append(f"it breaks off at byte {self._size:,}, since it was cut or its recorder killed")
        elif not self._indexed:
            troubles.append("all of it is there but its index, which only other programs need")
        return "; ".join(troubles) or None


_OUTLINED = frozenset({Opcode.HEADER, Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA, Opcode.ATTACHMENT})
_UNREADABLE = (
    *(struct.error, OverflowError, ValueError, McapError, MemoryError),
    *(batch.BatchError, batch.NewerFormatError),
)
"""Errors of the mcap library and of this package on damaged records."""


def _parsed(kind: type[ReadableT], content: bytes) -> ReadableT:
    """Parse a record with the mcap library, which does not notice reading past the end.

    Raises:
        ValueError, struct.error, McapError: it is damaged.
    """
    stream = ReadDataStream(BytesIO(content))
    # The records' common base has no such method.
    reader: Any = kind
    record: ReadableT = reader.read(stream)
    if stream.count > len(content):
        raise ValueError("it is too short")
    return record


def _parts(count: int) -> str:
    return "1 part of it is" if count == 1 else f"{count} parts of it are"
