"""A recorder on a thread of its own, for callers that must not wait for the disk."""

import atexit
import threading
from collections.abc import Sequence
from queue import SimpleQueue
from typing import TypeAlias

from sim.recording.recorder import APPEARING, RecordingWriter
from sim.trace.events import AnyEvent, MessageSent, Notice, Severity

_ROOM = 64_000_000
"""Bytes, estimated, that may wait to be recorded."""
_EVENT = 200
"""Bytes of an event, estimated, besides the contents of a message."""

_Batch: TypeAlias = Sequence[AnyEvent]


class BackgroundRecorder:
    """Queues events for ``recorder``, which runs on another thread.

    Events that come while the queue is full are dropped and counted, except those that introduce
    participants; a notice in the recording says where. One thread may call ``take`` and, later, ``close``;
    an interpreter that exits closes the recorder too.
    """

    def __init__(self, recorder: RecordingWriter, room: int = _ROOM) -> None:
        self.path = recorder.path
        self.lost = 0
        """How many events were dropped."""
        self._recorder = recorder
        self._room = room
        self._gap = 0
        self._waiting: SimpleQueue[_Batch | None] = SimpleQueue()
        # Two counters, as each is written by one thread.
        self._taken = 0
        self._written = 0
        self._closed = False
        self._worker = threading.Thread(target=self._write_for_ever, name="recording", daemon=True)
        self._worker.start()
        atexit.register(self.close)

    @property
    def count(self) -> int:
        """How many events are recorded so far."""
        return self._recorder.count

    @property
    def failure(self) -> str | None:
        """Why nothing is recorded any more; None as long as all goes well."""
        return self._recorder.failure

    @property
    def size(self) -> int:
        """Bytes in the file."""
        return self._recorder.size

    @property
    def waiting(self) -> int:
        """Bytes, estimated, that wait to be recorded."""
        return self._taken - self._written

    def take(self, events: _Batch) -> None:
        """Queue a batch without blocking."""
        if self.waiting > self._room:
            kept = [event for event in events if isinstance(event, APPEARING)]
            self._gap += len(events) - len(kept)
            self.lost += len(events) - len(kept)
            events = kept
        elif self._gap and events:
            events = [_gap_notice(events[0].t, self._gap), *events]
            self._gap = 0
        if events:
            self._taken += _size(events)
            self._waiting.put(events)

    def close(self) -> None:
        """Block until all is written, and finish the recording. Idempotent, for any thread."""
        if not self._closed:
            self._closed = True
            atexit.unregister(self.close)
            self._waiting.put(None)
        self._worker.join()

    def _write_for_ever(self) -> None:
        while (events := self._waiting.get()) is not None:
            self._recorder.take(events)
            self._written += _size(events)
        self._recorder.close()


def _size(events: _Batch) -> int:
    """Estimate the bytes of a batch."""
    held = sum(len(event.data or b"") for event in events if isinstance(event, MessageSent))
    return _EVENT * len(events) + held


def _gap_notice(t: int, lost: int) -> Notice:
    return Notice(t, Severity.WARN, f"{lost:,} events before this came faster than they could be recorded")
