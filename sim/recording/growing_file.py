"""A file that contains only complete writes, even if the disk fills up during one."""

import errno
import os
from contextlib import suppress
from io import FileIO


class GrowingFile:
    """Appends to a file without a buffer, and truncates it after a failed write.

    With ``end``, a byte such as a newline, the complete lines of a failed write stay. A pipe or a device
    cannot be truncated. Not thread-safe.
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
            self._truncate(self._length + (data.rfind(self._end, 0, written) + 1 if self._end else 0))
            raise
        self._length += written
        return written

    def clear(self) -> None:
        """Empty the file."""
        self._truncate(0)

    def flush(self) -> None:
        """Do nothing: the file has no buffer."""

    def close(self) -> None:
        """Close the file. Raises OSError: some file systems only report now that they are full."""
        self._file.close()

    def _truncate(self, length: int) -> None:
        with suppress(OSError):
            self._file.truncate(length)
            self._length = length
