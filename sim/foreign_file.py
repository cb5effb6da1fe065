"""Reads files that anybody may have written: regular files only, and none that is larger than a limit."""

import errno
import os
import stat
from io import BytesIO, TextIOWrapper
from pathlib import Path

MOST = 1_000_000
"""Bytes of a description, a manifest or a parameter file; usual ones have a few thousand."""
MOST_OF_A_PROGRAM = 10_000_000
"""Bytes of a program's source, or of data that a program reads as one text."""


_NOTHING_THERE = (errno.ENOENT, errno.ENOTDIR, errno.ELOOP)


def mode_of(path: Path) -> int:
    """What is at a path, for ``stat.S_ISREG`` and its like; 0 if there is nothing.

    From Python 3.14 on ``Path.exists`` and its like say no where they cannot know.

    Raises:
        OSError: it cannot be known: a folder on the way may not be searched, or the name is too long.
    """
    try:
        return path.stat().st_mode
    except OSError as error:
        if error.errno in _NOTHING_THERE:
            return 0
        raise
    except ValueError:  # no name of a file has a null character
        return 0


def read_bytes(path: Path, most: int = MOST) -> bytes:
    """What a file holds. Never waits for a pipe's other end, and never reads more than ``most`` bytes.

    Raises:
        OSError: it cannot be read, is no regular file (the null device counts as an empty one), or is too
            large; ``strerror`` says which.
    """
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    with os.fdopen(os.open(path, flags), "rb") as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode) and str(path) != os.devnull:
            raise OSError(errno.EINVAL, "it is a pipe or a device; give a file", str(path))
        data = file.read(most + 1)
    if len(data) > most:
        raise OSError(errno.EFBIG, f"it has more than {most:,} bytes, the most that are read", str(path))
    return data


def read_text(path: Path, most: int = MOST, errors: str = "strict") -> str:
    """The text of a file in UTF-8, with ``\\n`` at the end of each line.

    Raises:
        OSError: as ``read_bytes``.
        UnicodeDecodeError: it is not UTF-8.
    """
    return TextIOWrapper(BytesIO(read_bytes(path, most)), encoding="utf-8", errors=errors).read()


def text_of_program(path: Path) -> str | None:
    """The text of a program, with replacements for what is not text; None if it cannot be read."""
    try:
        return read_text(path, MOST_OF_A_PROGRAM, "replace")
    except OSError:
        return None
