"""A file that only ever holds whole writes, also when the disk fills up in the middle of one."""

import errno
import os
from contextlib import suppress
from io import FileIO


class GrowingFile:
    """Appends to a raw file without a buffer. Of a write that fails, nothing stays in the file.

    With ``end``, a byte, what such a write wrote up to the last ``end`` stays. A pipe or a device cannot be
    shortened: it keeps what it got. Not thread-safe.
    """

    def __init__(self, file: FileIO, end: bytes = b"") -> None:
        self._file = file
        self._end = end
        self._length = file.tell() if file.seekable() else 0

    def tell(self) -> int:
        """Bytes in the file."""
        return self._length

    def write(self, data: bytes) -> int:
        """Write all of ``data``. Raises OSError."""
        written = 0
        try:
            while written < len(data):
                taken = self._file.write(memoryview(data)[written:])
                if not taken:  # a pipe that does not block, and is full
                    raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))
                written += taken
        except OSError:
            self._shorten(self._length + (data.rfind(self._end, 0, written) + 1 if self._end else 0))
            raise
        self._length += written
        return written

    def clear(self) -> None:
        """Empty the file."""
        self._shorten(0)

    def flush(self) -> None:
        """Do nothing: whatever was written is with the system already."""

    def close(self) -> None:
        """Close the file. Raises OSError: some file systems find out now that they are full."""
        self._file.close()

    def _shorten(self, length: int) -> None:
        with suppress(OSError):
            self._file.truncate(length)
            self._length = length
