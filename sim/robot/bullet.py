"""PyBullet: imported when the first world is built, without output, one client per world."""

import ctypes
import importlib
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any


class WorldUnavailable(Exception):  # noqa: N818  (shown to a person)
    """No robot world can be built on this machine; the text says what to do."""


class BulletClient:
    """PyBullet's functions, bound to a DIRECT client of their own.

    Not thread-safe: one thread at a time. Two clients share nothing.
    """

    def __init__(self) -> None:
        """Import PyBullet and connect, without output.

        Raises:
            WorldUnavailable: PyBullet is missing, broken, or has no client left.
        """
        with silence():
            self._bullet = _import_bullet()
            self._id: int = self._bullet.connect(self._bullet.DIRECT)
        if self._id < 0:
            raise WorldUnavailable("PyBullet refused one more world: close the others, or start afresh.")

    def __getattr__(self, name: str) -> Any:
        """Return and cache a constant or a bound function by name."""
        found = getattr(self._bullet, name)
        bound = partial(found, physicsClientId=self._id) if callable(found) else found
        setattr(self, name, bound)
        return bound

    def close(self) -> None:
        """Disconnect; every later call raises `pybullet.error`. Closing again does nothing."""
        if self._id < 0:
            return
        with silence():
            self._bullet.disconnect(self._id)
        # The next client gets this number, and must not get calls of this one.
        bullet = self._bullet
        vars(self).clear()
        self._bullet, self._id = bullet, -1


def _import_bullet() -> Any:
    try:
        return importlib.import_module("pybullet")
    except ImportError as missing:
        raise WorldUnavailable(
            f"PyBullet cannot be imported by this Python ({missing}): `cbtui doctor` says how to install it; "
            "--physics numpy moves the robot without it, and the map shows it."
        ) from missing


@contextmanager
def silence() -> Iterator[None]:
    """Discard the process's standard output and error in the block, those of C code included.

    Output of other threads is lost, too.
    """
    _flush()
    kept = {}
    for stream in (1, 2):
        with suppress(OSError):  # a closed stream has no output
            kept[stream] = os.dup(stream)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for stream in kept:
            os.dup2(nowhere, stream)
        yield
    finally:
        _flush()
        for stream, copy in kept.items():
            os.dup2(copy, stream)
            os.close(copy)
        os.close(nowhere)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            with suppress(OSError, ValueError):
                stream.flush()
    # C's buffers, too: their text would be written after the block.
    ctypes.CDLL("msvcrt" if sys.platform == "win32" else None).fflush(None)
