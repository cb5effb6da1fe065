"""Writes files atomically: after a full disk, Ctrl-C or another failure the old file is still there."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO
from uuid import uuid4

_DEVICES = Path("/dev")


@contextmanager
def atomic_file(
    path: Path, *, replace: bool = True, follow: bool = True, mode: int = 0o666
) -> Iterator[BinaryIO]:
    """Open a file that replaces ``path`` at the end of the block, or is removed if the block raises.

    An existing file is replaced only with ``replace``, and keeps its permissions; a new one gets ``mode``,
    less the bits of the process's umask. A link is followed, or replaced itself without ``follow``. Pipes
    and devices are written to directly.

    Raises:
        FileExistsError: ``path`` exists, and ``replace`` is False.
        OSError: the file cannot be written.
    """
    target = Path(os.path.realpath(path)) if follow else path
    if path.is_relative_to(_DEVICES) or (target.exists() and not (target.is_file() or target.is_dir())):
        with path.open("wb") as file:
            yield file
        return
    if not replace and os.path.lexists(path):
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path))
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    part = target.with_name(f".{uuid4().hex}.part")
    try:
        with os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        if not replace:
            os.link(part, target)
            return
        with suppress(FileNotFoundError):
            part.chmod(target.stat().st_mode & 0o7777)
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)


def write_atomically(path: Path, content: bytes, **how: Any) -> None:
    """Write a file through ``atomic_file``, which gets the options ``how``."""
    with atomic_file(path, **how) as file:
        file.write(content)
