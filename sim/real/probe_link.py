"""Reads what processes tell, line by line: their probes, and what they print."""

import os
import socket
from collections.abc import Callable
from pathlib import Path
from selectors import EVENT_READ, BaseSelector
from typing import IO

import msgspec

from sim.probes.on_path.cbtui_probe import FOLLOW
from sim.real.wire import Hello, ProbeLine, Uncaught, decode_lines

_CHUNK = 1 << 16
"""Bytes that are read at once."""
_TO_ANSWER = 1.0
"""Seconds that a probe has to tell which process it is in."""


class LineReader:
    """Cuts what comes from a descriptor into lines. ``take`` gets whole ones, each with its end.

    At the end it gets what is left, and ``closed`` is told.
    """

    def __init__(
        self,
        selector: BaseSelector,
        source: socket.socket | IO[bytes],
        take: Callable[[bytes], None],
        closed: Callable[[], None],
    ) -> None:
        self._selector = selector
        self._source = source
        self._take = take
        self._closed = closed
        self._rest = b""
        os.set_blocking(source.fileno(), False)
        selector.register(source, EVENT_READ, self.read)

    def read(self) -> None:
        """Read what is there."""
        try:
            data = os.read(self._source.fileno(), _CHUNK)
        except BlockingIOError:
            return
        except OSError:  # the other side was killed
            data = b""
        whole, end, self._rest = (self._rest + data).rpartition(b"\n")
        if whole or end:
            self._take(whole + end)
        if not data:
            self._selector.unregister(self._source)
            self._source.close()
            if self._rest:
                self._take(self._rest)
            self._closed()


class ProbeLink:
    """The connection to the probe of one process. ``take`` gets what it tells."""

    def __init__(self, selector: BaseSelector, take: Callable[[list[ProbeLine]], None]) -> None:
        self.hello: Hello | None = None
        """Which process it is, once it has told."""
        self.uncaught: Uncaught | None = None
        """The exception that ended the program."""
        self.is_open = False
        self._selector = selector
        self._take = take

    def connect(self, path: Path) -> bool:
        """Listen to the probe at a socket, unless it is listened to; returns whether that is so now."""
        if self.is_open or self.hello is not None:
            return True
        connection = socket.socket(socket.AF_UNIX)
        try:
            connection.connect(str(path))
            connection.sendall(FOLLOW)
        except OSError:  # it does not listen yet, or not any more
            connection.close()
            return False
        self.is_open = True
        LineReader(self._selector, connection, self._told, self._closed)
        return True

    def _closed(self) -> None:
        self.is_open = False

    def _told(self, data: bytes) -> None:
        lines = decode_lines(data)
        for line in lines:
            if isinstance(line, Hello):
                self.hello = line
            elif isinstance(line, Uncaught):
                self.uncaught = line
        self._take(lines)


def processes_in(folder: Path) -> list[Hello]:
    """Ask the probes that listen in a folder which processes they are in; remove dead ones' sockets."""
    found = []
    for path in sorted(folder.glob("*.sock")):
        with socket.socket(socket.AF_UNIX) as visitor:
            visitor.settimeout(_TO_ANSWER)
            try:
                visitor.connect(str(path))
                with visitor.makefile("rb") as lines:
                    answer = decode_lines(lines.readline())
            except ConnectionRefusedError:
                path.unlink(missing_ok=True)
                continue
            except (OSError, msgspec.DecodeError):
                continue
        found += [line for line in answer if isinstance(line, Hello)]
    return found
