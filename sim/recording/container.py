"""The outer layer of an MCAP file, read so that damage costs no more than the records it lies in.

The mcap library's readers stop at the first thing that is wrong. Here a place that holds no record is left
out, up to the next chunk. Source: the MCAP specification, https://mcap.dev/spec.
"""

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC as MAGIC

HEAD = struct.Struct("<BQ")
"""What every record begins with: its opcode and its length."""
_FOOTER_LENGTH = 20
_DATA_END_LENGTH = 4
_CHUNK_FIELDS = struct.Struct("<QQQI")
"""A chunk's first and last time, the size and the checksum of what is in it."""
_COMPRESSIONS = re.compile(rb"\x03\0\0\0lz4|\x04\0\0\0zstd|\0\0\0\0")
_NAMED = re.compile(rb"\x03\0\0\0lz4|\x04\0\0\0zstd")
"""What stands in a chunk after these; chunks that are not compressed cannot be searched for."""
_TO_NAME = HEAD.size + _CHUNK_FIELDS.size
_WINDOW = 1_000_000
_FIRST_WINDOWS = 4_000_000
"""Bytes at the beginning of a file that is none by its first eight, among which a chunk is looked for."""
_PRIVATE = 0x80


@dataclass(frozen=True)
class Record:
    """A record's kind and where in the file its content is."""

    opcode: int
    offset: int
    length: int


@dataclass
class Container:
    """The records of an open file. What is wrong with it is known when they have been walked through."""

    file: BinaryIO
    size: int = 0
    gaps: list[int] = field(default_factory=list)
    """Where the file holds something else than a record, and goes on later."""
    whole: bool = False
    """Whether all records were written."""
    indexed: bool = False
    """Whether the index behind them was."""

    def __post_init__(self) -> None:
        self.size = self.file.seek(0, 2)

    def records(self) -> Iterator[Record]:
        """The records in order. A file that is no MCAP file has none."""
        self.file.seek(0)
        place: int | None = len(MAGIC)
        if self.file.read(len(MAGIC)) != MAGIC:
            place = self._next_chunk(0, min(self.size, _FIRST_WINDOWS))
            if place is not None:
                self.gaps.append(0)
        last = 0
        while place is not None and place < self.size:
            record = self._record_at(place)
            if record is None:
                # It may be the record before that has a wrong length.
                gap, place = place, self._next_chunk(last + 1, self.size)
                if place is not None:
                    self.gaps.append(gap)
                continue
            last = place
            yield record
            self.whole = self.whole or record.opcode == Opcode.DATA_END
            if record.opcode == Opcode.FOOTER:
                self.indexed = True
                return
            place = record.offset + record.length

    def read(self, record: Record) -> bytes:
        """A record's content."""
        self.file.seek(record.offset)
        return self.file.read(record.length)

    def _record_at(self, place: int) -> Record | None:
        self.file.seek(place)
        head = self.file.read(HEAD.size)
        if len(head) < HEAD.size:
            return None
        opcode, length = HEAD.unpack(head)
        end = place + HEAD.size + length
        if not (Opcode.HEADER <= opcode <= Opcode.DATA_END or opcode >= _PRIVATE) or end > self.size:
            return None
        if opcode == Opcode.FOOTER and not self._ends(length, end):
            return None
        if opcode == Opcode.DATA_END and length != _DATA_END_LENGTH:
            return None
        if opcode == Opcode.CHUNK and not self._is_chunk():
            return None
        return Record(opcode, place + HEAD.size, length)

    def _ends(self, length: int, end: int) -> bool:
        self.file.seek(end)
        return length == _FOOTER_LENGTH and end + len(MAGIC) == self.size and self.file.read() == MAGIC

    def _is_chunk(self) -> bool:
        """Whether the file goes on as a chunk's content does."""
        self.file.seek(_CHUNK_FIELDS.size, 1)
        return _COMPRESSIONS.match(self.file.read(8)) is not None

    def _next_chunk(self, start: int, end: int) -> int | None:
        """Where the next chunk begins whose content is compressed."""
        while start < end:
            self.file.seek(start)
            window = self.file.read(_WINDOW + _TO_NAME + 8)
            for found in _NAMED.finditer(window, _TO_NAME):
                place = start + found.start() - _TO_NAME
                if window[place - start] == Opcode.CHUNK and self._record_at(place) is not None:
                    return place
            start += _WINDOW
        return None
