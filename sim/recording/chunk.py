"""Chunks of an MCAP file: verified, unpacked within bounds, and split into records."""

import struct
import sys
import zlib
from collections.abc import Iterator

import lz4.frame

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

from sim.recording.container import HEAD

_FIELDS = struct.Struct("<QQQI")
_LENGTH = struct.Struct("<I")
_COMPRESSED_LENGTH = struct.Struct("<Q")
_MOST = 256_000_000
"""Bytes that a chunk may unpack to: the largest message and a little."""
_MOST_LZ4 = 255
"""The highest compression ratio of lz4."""
_FEW = 100_000_000
"""Bytes that any recording may unpack to, whatever its size."""


def unpacked_most(size: int) -> int:
    """Bytes that a recording may unpack to at most: its size times the highest compression ratio of lz4."""
    return max(_FEW, _MOST_LZ4 * size)


class ChunkError(Exception):
    """The chunk is damaged or cannot be unpacked."""


def unpack_chunk(chunk: bytes) -> bytes:
    """Unpack a chunk record.

    Raises:
        ChunkError: it is damaged, too large, or compressed in an unknown way.
    """
    try:
        _, _, size, checksum = _FIELDS.unpack_from(chunk)
        (name_length,) = _LENGTH.unpack_from(chunk, _FIELDS.size)
        start = _FIELDS.size + _LENGTH.size + name_length
        compression = chunk[_FIELDS.size + _LENGTH.size : start]
        (length,) = _COMPRESSED_LENGTH.unpack_from(chunk, start)
    except struct.error:
        raise ChunkError("it is too short") from None
    packed = chunk[start + _COMPRESSED_LENGTH.size :]
    if length != len(packed) or size > _MOST:
        raise ChunkError("its size is wrong")
    unpacked = _decompress(compression, packed, size)
    if len(unpacked) != size or (checksum and zlib.crc32(unpacked) != checksum):
        raise ChunkError("its checksum is wrong")
    return unpacked


def _decompress(compression: bytes, packed: bytes, size: int) -> bytes:
    """Decompress to at most ``size`` bytes, whatever the header claims."""
    try:
        match compression:
            case b"":
                return packed
            case b"lz4":
                most = min(size, _MOST_LZ4 * len(packed))
                return bytes(lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=most))
            case b"zstd":
                return bytes(zstd.ZstdDecompressor().decompress(packed, max_length=size))
    except (RuntimeError, EOFError, ValueError, MemoryError, zstd.ZstdError) as error:
        raise ChunkError(str(error)) from None
    raise ChunkError("it is compressed in an unknown way")


def records_in(content: bytes) -> Iterator[tuple[int, int, int]]:
    """Opcode, start and end of every record in a chunk's content.

    Raises:
        ChunkError: there is something else in it.
    """
    place, size = 0, len(content)
    while place < size:
        if place + HEAD.size > size:
            raise ChunkError("its records are damaged")
        opcode, length = HEAD.unpack_from(content, place)
        place += HEAD.size
        if place + length > size:
            raise ChunkError("its records are damaged")
        yield opcode, place, place + length
        place += length
