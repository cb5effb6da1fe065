"""Keeps all events of a run as they came, in a temporary file, for whoever wants them again later."""

from collections.abc import Iterator, Sequence
from io import FileIO
from tempfile import TemporaryFile
from threading import Lock
from typing import cast
from weakref import finalize

from lz4 import frame

from sim.trace.events import AnyEvent, MessageSent, decode, encode
from sim.trace.model import Nanoseconds

MOST = 512_000_000
"""Bytes that a tape's file may have, unless it is told otherwise: millions of events take a tenth of it."""
_BLOCK = 128_000
"""Bytes of events that are put into the file at once."""
_LENGTH = 4
"""Bytes before each batch, and in the file before each block, that tell how long it is."""


class Tape:
    """The events of a run from its beginning, packed, in a file without a name that is gone with the tape.

    The file lies in the system's folder for temporary files and is made when it is needed. A tape that is
    full, since it has ``most`` bytes or its folder has no more room, takes nothing more and says so. What
    messages contain is not kept: that is for recordings.
    One thread may call ``take``; ``batches`` may be called, and gone through, on any other meanwhile.
    """

    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self._lock = Lock()
        self._file: FileIO | None = None
        self._length = 0
        self._waiting = bytearray()
        self._ended_at: Nanoseconds | None = None
        self._why = ""

    @property
    def size(self) -> int:
        """Bytes in the file."""
        return self._length

    @property
    def missing(self) -> str:
        """One sentence on what is missing; empty if nothing is."""
        if self._ended_at is None:
            return ""
        return f"what came after {self._ended_at / 1e9:.3f} s is missing, since {self._why}"

    def take(self, events: Sequence[AnyEvent]) -> None:
        """Keep a batch, unless the tape is full."""
        if not events or self._ended_at is not None:
            return
        packed = encode([each for each in events if not isinstance(each, MessageSent) or each.data is None])
        with self._lock:
            self._waiting += len(packed).to_bytes(_LENGTH) + packed
            full = len(self._waiting) >= _BLOCK and not self._put_by()
        if full:
            self._ended_at = events[-1].t

    def batches(self) -> Iterator[list[AnyEvent]]:
        """What has been taken until now, batch after batch; what comes meanwhile is not among it.

        Raises:
            OSError: the file cannot be read.
        """
        with self._lock:
            end, waiting = self._length, bytes(self._waiting)
        place = 0
        while place < end:
            block, place = self._block(place)
            yield from _unpacked(block)
        yield from _unpacked(waiting)

    def _put_by(self) -> bool:
        """Write what waits to the file; whether the tape can take more."""
        block = frame.compress(bytes(self._waiting))
        try:
            file = self._opened()
            file.seek(self._length)
            data = len(block).to_bytes(_LENGTH) + block
            if self._length + len(data) > self._most:
                self._why = f"no more than {self._most // 1_000_000} MB of a run are kept"
            elif file.write(data) != len(data):
                self._why = "the folder for temporary files is full"
        except OSError as error:
            self._why = f"the temporary file cannot be written: {error.strerror}"
        if self._why:
            return False
        self._length += len(data)
        self._waiting.clear()
        return True

    def _block(self, place: int) -> tuple[bytes, int]:
        """The block at a place, and the place behind it."""
        with self._lock:
            file = self._opened()
            file.seek(place)
            length = int.from_bytes(file.read(_LENGTH))
            packed = file.read(length)
        return cast("bytes", frame.decompress(packed)), place + _LENGTH + length

    def _opened(self) -> FileIO:
        if self._file is None:
            file = TemporaryFile(buffering=0, prefix="cbtui-")  # noqa: SIM115  # closed with the owner
            self._file = file
            finalize(self, file.close)
        return self._file


def _unpacked(block: bytes) -> Iterator[list[AnyEvent]]:
    """The batches of a block."""
    place = 0
    while place < len(block):
        start = place + _LENGTH
        place = start + int.from_bytes(block[place:start])
        yield decode(block[start:place])
