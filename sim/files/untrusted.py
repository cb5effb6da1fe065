"""Reads untrusted files: regular files only, up to a limit of bytes."""

import errno
import os
import stat
from io import BytesIO, TextIOWrapper
from pathlib import Path

MAX_BYTES = 1_000_000
"""Limit for a description, a manifest or a parameter file; usual ones have a few thousand bytes."""
MAX_PROGRAM_BYTES = 10_000_000
"""Limit for a program's source, or for data that a program reads as one text."""
_NOTHING_THERE = (errno.ENOENT, errno.ENOTDIR, errno.ELOOP)


def mode_of(path: Path) -> int:
    """Return what is at a path, for ``stat.S_ISREG`` and its like; 0 if there is nothing.

    ``Path.exists`` and its like return False from Python 3.14 on where this raises an error.

    Raises:
        OSError: a folder on the way may not be searched, or the name is too long.
    """
    try:
        return path.stat().st_mode
    except OSError as error:
        if error.errno in _NOTHING_THERE:
            return 0
        raise
    except ValueError:  # a file's name has no null character
        return 0


def read_bytes(path: Path, most: int = MAX_BYTES) -> bytes:
    """Return a file's content. Does not wait for the other end of a pipe.

    Raises:
        OSError: the file cannot be read, is not a regular file (the null device counts as an empty one), or
            has more than ``most`` bytes; ``strerror`` says which.
    """
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    with os.fdopen(os.open(path, flags), "rb") as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode) and str(path) != os.devnull:
            raise OSError(errno.EINVAL, "it is a pipe or a device; give a file", str(path))
        data = file.read(most + 1)
    if len(data) > most:
        raise OSError(errno.EFBIG, f"it has more than {most:,} bytes, the most that are read", str(path))
    return data


def read_text(path: Path, most: int = MAX_BYTES, errors: str = "strict") -> str:
    """Return the text of a file in UTF-8; each line ends in ``\\n``.

    Raises:
        OSError: as ``read_bytes``.
        UnicodeDecodeError: the file is not UTF-8.
    """
    return TextIOWrapper(BytesIO(read_bytes(path, most)), encoding="utf-8", errors=errors).read()


def decoding_fault(error: UnicodeDecodeError) -> str:
    """Return the line at which a text cannot be decoded, and why.

    As ``12: the byte 0xff is not UTF-8; save the file as UTF-8``.
    """
    line = error.object.count(b"\n", 0, error.start) + 1
    byte = error.object[error.start]
    return f"{line}: the byte 0x{byte:02x} is not {error.encoding.upper()}; save the file as UTF-8"


def program_text(path: Path) -> str | None:
    """Return the text of a program; None if it cannot be read. Bytes that are not UTF-8 are replaced."""
    try:
        return read_text(path, MAX_PROGRAM_BYTES, "replace")
    except (OSError, ValueError):  # a file's name has no null character
        return None
