"""Writes a recording in chunks, so that a killed process loses little."""

import sys
import threading
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import MappingProxyType
from typing import Any

from mcap.writer import CompressionType, Writer

from sim.recording import batch
from sim.recording.growing_file import GrowingFile
from sim.recording.metadata import NAME, RecordingMetadata, to_metadata
from sim.recording.source_files import SourceAttachments
from sim.trace.events import (
    AnyEvent,
    ArenaShown,
    CallbackFailed,
    EntityAppeared,
    ExecutorAppeared,
    GroupAppeared,
    MessageSent,
    NodeAppeared,
    ProcessAppeared,
    RunStarted,
    ThreadAppeared,
    TimePassed,
    TopicAppeared,
    TopicId,
)

LIBRARY = "cbtui"
EVENTS_CHANNEL = 1
"""The id of the channel of events, which is registered first."""
_CHUNK = 256_000
"""Bytes of a chunk in a longer recording."""
_FIRST_CHUNK = 8_000
"""Bytes of the first chunk: a disk that is nearly full has little room."""
_GROWTH = 0.25
"""Size of the next chunk relative to all chunks before it: so much may be lost if it cannot be written."""
_PERIOD = 0.5
"""Seconds after which waiting data is written."""
_COPIES = 10
"""How often the participants are attached again while more appear."""
_ROSBAG = ("rosbag2", {"ROS_DISTRO": "jazzy"})
"""The metadata record in which rosbag2 names its ROS 2 distribution."""
APPEARING = (
    RunStarted,
    ProcessAppeared,
    ThreadAppeared,
    ExecutorAppeared,
    NodeAppeared,
    GroupAppeared,
    EntityAppeared,
    ArenaShown,
    TopicAppeared,
)
"""Events that introduce participants."""


class RecordingWriter:
    """Records events, and messages with their topics, to a new ``.mcap`` file. Thread-safe.

    Rosbag2, rosbags and Foxglove can read the topics, which have rosbag2's metadata. Events are on a channel
    of their own; of ``TimePassed`` only the last one is written. An error such as a full disk does not end
    the run: ``failure`` has its text, and nothing more is recorded. ``texts`` were run in place of files.

    Raises:
        FileExistsError: there is such a file, and ``replace`` is not wanted.
        OSError: the file cannot be made.
    """

    def __init__(
        self,
        path: Path,
        about: RecordingMetadata,
        *,
        replace: bool = False,
        texts: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self.path = path
        self.count = 0
        """How many events were recorded, without messages, which are their topics'."""
        self.failure: str | None = None
        self._epoch = 0
        self._batches = 0
        self._channels: dict[TopicId, int] = {}
        self._sent: dict[TopicId, int] = {}
        self._participants: list[AnyEvent] = []
        self._attached = 0
        self._latest = 0
        self._passed: TimePassed | None = None
        self._copies_left = _COPIES
        self._lock = threading.Lock()
        self._closing = threading.Event()
        self._chunked = 0
        self._waiting = 0
        self._file = GrowingFile(path.open("wb" if replace else "xb", buffering=0))
        # Of a stream, the library wants these few methods only.
        stream: Any = self._file
        self._writer: Any = Writer(stream, chunk_size=sys.maxsize, compression=CompressionType.LZ4)
        self._sources = SourceAttachments(texts)
        self._flusher = threading.Thread(target=self._flush_for_ever, name="recorder", daemon=True)
        self._guarded(lambda: self._begin(about))
        self._flusher.start()

    @property
    def size(self) -> int:
        """Bytes in the file."""
        return self._file.tell()

    def take(self, events: Iterable[AnyEvent]) -> None:
        """Record a batch: events on their channel, messages under their topics."""
        self._guarded(lambda: self._take(events))

    def flush(self) -> None:
        """Write waiting data, so that it survives this process."""
        self._guarded(self._flush)

    def close(self) -> None:
        """Write the rest and the index. Idempotent."""
        if self._closing.is_set():
            return
        self._closing.set()
        self._flusher.join()
        self._copies_left = 1
        self.flush()
        self._guarded(lambda: self._sources.attach(self._attach))
        self._guarded(self._attach_participants)
        self._guarded(self._record_end)
        self._guarded(self._writer.finish)
        try:
            self._file.close()
        except OSError as error:
            self.failure = self.failure or error.strerror

    def _guarded(self, step: Callable[[], object]) -> None:
        """Run a step on the file unless an earlier one failed; keep its error in ``failure``."""
        with self._lock:
            if self.failure is None:
                try:
                    step()
                except OSError as error:
                    self.failure = error.strerror or str(error)

    def _begin(self, about: RecordingMetadata) -> None:
        self._writer.start(profile="ros2", library=f"{LIBRARY} {_version()}")
        self._writer.add_metadata(NAME, to_metadata(about))
        self._writer.add_metadata(*_ROSBAG)
        schema = self._writer.register_schema(batch.TYPE, "ros2msg", batch.DEFINITION.encode())
        self._writer.register_channel(batch.TOPIC, "cdr", schema)
        for path in about.programs:
            self._sources.request(path)

    def _take(self, events: Iterable[AnyEvent]) -> None:
        kept: list[AnyEvent] = []
        for event in events:
            handle = _HANDLERS.get(event.__class__)
            if handle is None or handle(self, event):
                kept.append(event)
        if kept:
            self._add_events(kept)

    def _add_events(self, events: list[AnyEvent]) -> None:
        """Add a batch, in halves if it is larger than a chunk."""
        packed = batch.pack_batch(events)
        if len(packed) > self._chunk_size and len(events) > 1:
            half = len(events) // 2
            self._add_events(events[:half])
            self._add_events(events[half:])
        else:
            self._latest = max(self._latest, events[-1].t)
            self._batches += 1
            self.count += len(events)
            self._add(EVENTS_CHANNEL, self._epoch + events[0].t, packed, self._batches)

    def _add(self, channel: int, time: int, data: bytes, number: int) -> None:
        if self._waiting + len(data) > self._chunk_size:
            self._flush()
        self._writer.add_message(channel, time, data, time, number)
        self._waiting += len(data)

    @property
    def _chunk_size(self) -> int:
        """Bytes of the next chunk: a share of those before it, since it may not fit on the disk."""
        return min(_CHUNK, max(_FIRST_CHUNK, int(_GROWTH * self._chunked)))

    def _flush(self) -> None:
        """Write waiting data as a chunk; the programs' files, which may be large, follow the first chunk."""
        self._writer.flush()
        self._chunked += self._waiting
        self._waiting = 0
        if self._chunked:
            self._sources.attach(self._attach)

    # Handlers: each returns whether the event goes on the channel of events.

    def _run_started(self, event: RunStarted) -> bool:
        self._epoch = event.epoch
        return self._appeared(event)

    def _entity_appeared(self, event: EntityAppeared) -> bool:
        self._sources.request(event.file)
        return self._appeared(event)

    def _callback_failed(self, event: CallbackFailed) -> bool:
        self._sources.request(event.file)
        return True

    def _appeared(self, event: AnyEvent) -> bool:
        self._participants.append(event)
        return True

    def _topic(self, event: TopicAppeared) -> bool:
        if event.topic not in self._channels:
            schema = self._writer.register_schema(event.message_type, "ros2msg", event.definition.encode())
            texts = {"offered_qos_profiles": event.offered_qos, "topic_type_hash": event.type_hash}
            metadata = {name: text for name, text in texts.items() if text}
            self._channels[event.topic] = self._writer.register_channel(event.name, "cdr", schema, metadata)
        return False

    def _message(self, event: MessageSent) -> bool:
        if event.data is None:
            return True
        channel = self._channels.get(event.topic)
        if channel is not None:
            time = self._epoch + event.t
            number = self._sent[event.topic] = self._sent.get(event.topic, 0) + 1
            self._add(channel, time, event.data, number)
        return False

    def _time_passed(self, event: TimePassed) -> bool:
        self._passed = event
        return False

    def _record_end(self) -> None:
        """Record how long the run went on after its last event."""
        if self._passed is not None and self._passed.t > self._latest:
            self._add_events([self._passed])

    def _attach(self, path: str, text: bytes) -> None:
        self._writer.add_attachment(0, self._epoch, path, "text/x-python", text)

    def _flush_for_ever(self) -> None:
        while not self._closing.wait(_PERIOD):
            self._guarded(self._attach_participants)
            self.flush()

    def _attach_participants(self) -> None:
        """Attach the participants again: without them little could be read if their chunk is damaged."""
        if len(self._participants) > self._attached and self._copies_left > 0:
            self._copies_left -= 1
            self._attached = len(self._participants)
            self._writer.add_attachment(
                0, self._epoch, "cast", batch.PARTICIPANTS, batch.pack_batch(self._participants)
            )


_HANDLERS: dict[type, Callable[[RecordingWriter, Any], bool]] = {
    **dict.fromkeys(APPEARING, RecordingWriter._appeared),
    RunStarted: RecordingWriter._run_started,
    EntityAppeared: RecordingWriter._entity_appeared,
    CallbackFailed: RecordingWriter._callback_failed,
    TimePassed: RecordingWriter._time_passed,
    TopicAppeared: RecordingWriter._topic,
    MessageSent: RecordingWriter._message,
}


@cache
def _version() -> str:
    return version("cbtui")
