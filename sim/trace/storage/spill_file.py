"""A temporary file for a timeline's older data, with a cache of the blocks read last."""

import errno
import os
from collections import OrderedDict
from collections.abc import Callable
from functools import cached_property
from io import FileIO
from tempfile import TemporaryFile
from typing import Any, TypeVar, cast
from weakref import finalize

Decoded = TypeVar("Decoded")

CACHE_SIZE = 4_000_000
"""Bytes of decoded blocks that stay in memory."""

ENTRIES_IN_BLOCK = 1024
"""The maximum number of rows or items in a block."""


class SpillFile:
    """An anonymous temporary file of blocks, and a cache of the decoded blocks that were read last.

    The file is created with the first block and closed with its owner. If it cannot be created or the disk
    is full, blocks stay in memory, and queries work as before. ``cache_size`` is in bytes; a block should
    have at most ``entries`` rows or items. Not thread-safe, like the timeline that owns it.
    """

    def __init__(self, cache_size: int = CACHE_SIZE, entries: int = ENTRIES_IN_BLOCK) -> None:
        self.entries = entries
        self.failure = ""
        """Why the file cannot be written; empty while it can."""
        self._length = 0
        self._in_memory: dict[int, bytes] = {}
        self._cache: OrderedDict[int, tuple[int, Any]] = OrderedDict()
        self._cached = 0
        self._cache_size = cache_size

    def append(self, data: bytes) -> int:
        """Store a block and return its offset in the file; a negative one is the key of a block in memory."""
        if self._write(self._length, data):
            place = self._length
            self._length += len(data)
        else:
            place = -1 - len(self._in_memory)
            self._in_memory[place] = data
        return place

    def replace(self, place: int, data: bytes) -> None:
        """Overwrite a block with another one of the same length."""
        if place < 0 or not self._write(place, data):
            self._in_memory[place] = data

    def read(
        self, place: int, length: int, decode: Callable[[bytes], Decoded], memory_factor: int = 1
    ) -> Decoded:
        """Return the decoded block at an offset; the same object while it is in the cache.

        ``memory_factor`` is the approximate memory of a decoded block relative to its bytes.
        """
        cache = self._cache
        if place in cache:
            cache.move_to_end(place)
            return cast("Decoded", cache[place][1])
        decoded = decode(self._bytes_at(place, length))
        cache[place] = length * memory_factor, decoded
        self._cached += length * memory_factor
        while self._cached > self._cache_size:
            _, (size, _) = cache.popitem(last=False)
            self._cached -= size
        return decoded

    def discard(self, place: int) -> None:
        """Drop a block that is not needed any more."""
        size, _ = self._cache.pop(place, (0, None))
        self._cached -= size
        if place in self._in_memory:
            self._in_memory[place] = b""

    def _bytes_at(self, place: int, length: int) -> bytes:
        if place in self._in_memory:
            return self._in_memory[place]
        self._file.seek(place)
        return cast("bytes", self._file.read(length))

    def _write(self, place: int, data: bytes) -> bool:
        if self.failure:
            return False
        try:
            self._file.seek(place)
            if self._file.write(data) != len(data):
                self.failure = os.strerror(errno.ENOSPC)
        except OSError as error:
            self.failure = error.strerror or str(error)
        return not self.failure

    @cached_property
    def _file(self) -> FileIO:
        return temporary_file(self)


def temporary_file(owner: object) -> FileIO:
    """A new temporary file without a name, which is closed with its owner."""
    file = TemporaryFile(buffering=0, prefix="cbtui-")  # noqa: SIM115
    finalize(owner, file.close)
    return file
