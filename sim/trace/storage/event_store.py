"""Keeps the events of a live run in a temporary file, for exports."""

from collections.abc import Iterator, Sequence
from functools import cached_property
from io import FileIO
from threading import Lock
from typing import cast

from lz4 import frame

from sim.trace.events import AnyEvent, MessageSent, decode, encode
from sim.trace.model import Nanoseconds
from sim.trace.storage.spill_file import temporary_file

SIZE_LIMIT = 512_000_000
"""Default limit of the file in bytes: millions of events take a tenth of it."""
_BLOCK = 128_000
"""Bytes of packed events that are compressed and written together."""
_LENGTH = 4
"""Bytes of the length prefix of each batch, and of each block in the file."""


class EventStore:
    """The events of a run, compressed, in an anonymous temporary file.

    The file is created with the first block and closed with the store. When it reaches ``size_limit`` bytes
    or the disk is full, later events are dropped, and ``missing`` says so. Contents of messages are not
    stored: recordings have them. One thread may call ``take`` while another one iterates over ``batches``.
    """

    def __init__(self, size_limit: int = SIZE_LIMIT) -> None:
        self._size_limit = size_limit
        self._lock = Lock()
        self.size = 0
        """Bytes in the file."""
        self._waiting = bytearray()
        self._ended_at: Nanoseconds | None = None
        self._full_because = ""

    @property
    def missing(self) -> str:
        """One sentence on what is missing; empty if nothing is."""
        if self._ended_at is None:
            return ""
        return f"what came after {self._ended_at / 1e9:.3f} s is missing, since {self._full_because}"

    def take(self, events: Sequence[AnyEvent]) -> None:
        """Store a batch, unless the store is full."""
        if not events or self._ended_at is not None:
            return
        packed = encode([each for each in events if not isinstance(each, MessageSent) or each.data is None])
        with self._lock:
            self._waiting += len(packed).to_bytes(_LENGTH) + packed
            full = len(self._waiting) >= _BLOCK and not self._write_block()
        if full:
            self._ended_at = events[-1].t

    def batches(self) -> Iterator[list[AnyEvent]]:
        """The batches stored before this call, in order.

        Raises:
            OSError: the file cannot be read.
        """
        with self._lock:
            end, waiting = self.size, bytes(self._waiting)
        place = 0
        while place < end:
            block, place = self._block(place)
            yield from _unpacked(block)
        yield from _unpacked(waiting)

    def _write_block(self) -> bool:
        """Write the waiting batches as a block; False if the store is full."""
        block = frame.compress(bytes(self._waiting))
        try:
            self._file.seek(self.size)
            data = len(block).to_bytes(_LENGTH) + block
            if self.size + len(data) > self._size_limit:
                self._full_because = f"no more than {self._size_limit // 1_000_000} MB of a run are kept"
            elif self._file.write(data) != len(data):
                self._full_because = "the folder for temporary files is full"
        except OSError as error:
            self._full_because = f"the temporary file cannot be written: {error.strerror}"
        if self._full_because:
            return False
        self.size += len(data)
        self._waiting.clear()
        return True

    def _block(self, place: int) -> tuple[bytes, int]:
        """The block at an offset, and the offset of the next one."""
        with self._lock:
            self._file.seek(place)
            length = int.from_bytes(self._file.read(_LENGTH))
            packed = self._file.read(length)
        return cast("bytes", frame.decompress(packed)), place + _LENGTH + length

    @cached_property
    def _file(self) -> FileIO:
        return temporary_file(self)


def _unpacked(block: bytes) -> Iterator[list[AnyEvent]]:
    """Decode the batches of a block."""
    place = 0
    while place < len(block):
        start = place + _LENGTH
        place = start + int.from_bytes(block[place:start])
        yield decode(block[start:place])
