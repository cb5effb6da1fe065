"""Where a timeline puts what is old: bytes in a temporary file without a name, read back by place."""

import errno
import os
from collections import OrderedDict
from collections.abc import Callable
from io import FileIO
from tempfile import TemporaryFile
from typing import Any, TypeVar, cast
from weakref import finalize

Decoded = TypeVar("Decoded")

AT_HAND = 8_000_000

ENTRIES_IN_BLOCK = 1024


class Spill:
    """A temporary file of blocks that is gone when its owner is, and the blocks that were looked at last.

    The file lies in the system's folder for temporary files and is made when the first block comes. Where it
    cannot be made or is full, blocks stay in memory: a timeline then grows, and answers all the same.
    No block should have more than so many ``entries``; ``at_hand`` is how many bytes of decoded blocks stay.
    Not thread-safe, like the timeline that owns it.
    """

    def __init__(self, at_hand: int = AT_HAND, entries: int = ENTRIES_IN_BLOCK) -> None:
        self.entries = entries
        self._file: FileIO | None = None
        self.failure = ""
        """Why the file takes no more; empty as long as it does."""
        self._length = 0
        self._kept: dict[int, bytes] = {}
        self._at_hand: OrderedDict[int, tuple[int, Any]] = OrderedDict()
        self._weight = 0
        self._room = at_hand

    def put(self, data: bytes) -> int:
        """Put bytes by; tells at which place: below 0 in memory, else so many bytes into the file."""
        if self._written(self._length, data):
            place = self._length
            self._length += len(data)
        else:
            place = -1 - len(self._kept)
            self._kept[place] = data
        return place

    def replace(self, place: int, data: bytes) -> None:
        """Put others in the place of bytes, as many as there were."""
        if place < 0 or not self._written(place, data):
            self._kept[place] = data

    def look_up(
        self, place: int, length: int, decode: Callable[[bytes], Decoded], swelling: int = 1
    ) -> Decoded:
        """What was put at a place, decoded: the same object while it is among those looked at last.

        ``swelling`` is about how many times as much memory the decoded takes.
        """
        at_hand = self._at_hand
        if place in at_hand:
            at_hand.move_to_end(place)
            return cast("Decoded", at_hand[place][1])
        decoded = decode(self._read(place, length))
        at_hand[place] = length * swelling, decoded
        self._weight += length * swelling
        while self._weight > self._room:
            _, (weight, _) = at_hand.popitem(last=False)
            self._weight -= weight
        return decoded

    def forget(self, place: int) -> None:
        """What was put at a place is not needed any more."""
        weight, _ = self._at_hand.pop(place, (0, None))
        self._weight -= weight
        if place in self._kept:
            self._kept[place] = b""

    def _read(self, place: int, length: int) -> bytes:
        if place in self._kept:
            return self._kept[place]
        file = self._opened()
        file.seek(place)
        return cast("bytes", file.read(length))

    def _written(self, place: int, data: bytes) -> bool:
        if self.failure:
            return False
        try:
            file = self._opened()
            file.seek(place)
            if file.write(data) != len(data):
                self.failure = os.strerror(errno.ENOSPC)
        except OSError as error:
            self.failure = error.strerror or str(error)
        return not self.failure

    def _opened(self) -> FileIO:
        if self._file is None:
            file = TemporaryFile(buffering=0, prefix="cbtui-")  # noqa: SIM115  # closed with the owner
            self._file = file
            finalize(self, self._file.close)
        return self._file
