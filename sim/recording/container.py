"""Reads the records of an MCAP file; damage costs no more than the damaged records.

The mcap library's readers stop at the first error. This one skips to the next chunk. Source: the MCAP
specification, https://mcap.dev/spec.
"""

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC as MAGIC

HEAD = struct.Struct("<BQ")
"""Header of every record: opcode and length."""
_FOOTER_LENGTH = 20
_DATA_END_LENGTH = 4
_CHUNK_FIELDS = struct.Struct("<QQQI")
"""First and last time of a chunk, uncompressed size and checksum."""
_COMPRESSIONS = re.compile(rb"\x03\0\0\0lz4|\x04\0\0\0zstd|\0\0\0\0")
_NAMED = re.compile(rb"\x03\0\0\0lz4|\x04\0\0\0zstd")
"""The name of the compression that follows; uncompressed chunks cannot be found by it."""
_TO_NAME = HEAD.size + _CHUNK_FIELDS.size
_WINDOW = 1_000_000
_FIRST_WINDOWS = 4_000_000
"""Bytes in which a chunk is searched for if the first eight bytes are not those of an MCAP file."""
_PRIVATE = 0x80


@dataclass(frozen=True)
class Record:
    """Opcode of a record, and offset and length of its content in the file."""

    opcode: int
    offset: int
    length: int


@dataclass
class Container:
    """The records of an open file. Its damage is known after ``records`` has ended."""

    file: BinaryIO
    size: int = 0
    gaps: list[int] = field(default_factory=list)
    """Offsets at which records are damaged and others follow."""
    complete: bool = False
    """Whether the data section is complete."""
    indexed: bool = False
    """Whether it ends with its index."""

    def __post_init__(self) -> None:
        self.size = self.file.seek(0, 2)

    def records(self) -> Iterator[Record]:
        """The records in order; none for a file that is not an MCAP file."""
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
                # The length of the previous record may be wrong.
                gap, place = place, self._next_chunk(last + 1, self.size)
                if place is not None:
                    self.gaps.append(gap)
                continue
            last = place
            yield record
            self.complete = self.complete or record.opcode == Opcode.DATA_END
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
        """Whether the content at the current offset is that of a chunk."""
        self.file.seek(_CHUNK_FIELDS.size, 1)
        return _COMPRESSIONS.match(self.file.read(8)) is not None

    def _next_chunk(self, start: int, end: int) -> int | None:
        """The offset of the next compressed chunk."""
        while start < end:
            self.file.seek(start)
            window = self.file.read(_WINDOW + _TO_NAME + 8)
            for found in _NAMED.finditer(window, _TO_NAME):
                place = start + found.start() - _TO_NAME
                if window[place - start] == Opcode.CHUNK and self._record_at(place) is not None:
                    return place
            start += _WINDOW
        return None
