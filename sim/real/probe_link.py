"""Reads lines from processes: from their probes, and from their output."""

import os
import socket
from collections.abc import Callable
from pathlib import Path
from selectors import EVENT_READ, BaseSelector
from typing import IO, TypeAlias

import msgspec

from sim.probes.on_path.cbtui_probe import FOLLOW, TOKEN
from sim.real.wire import Hello, Left, ProbeLine, Uncaught, decode_lines

_CHUNK = 1 << 16
"""Bytes that are read at once."""
_TO_ANSWER = 1.0
"""Seconds that a probe has to send the id of its process."""


Place: TypeAlias = Path | tuple[str, int]
"""Where a probe listens: a socket of this user, or a host and port."""


class LineReader:
    """Splits what a descriptor delivers into lines. ``take`` gets whole lines, each with its newline.

    At the end of the input it gets the rest, and ``closed`` is called.
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
        self._is_open = True
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
            self._is_open = False
            self._selector.unregister(self._source)
            self._source.close()
            self._take_rest()
            self._closed()

    def read_all(self) -> None:
        """Read what is available, and pass it on even if it is not a whole line."""
        if self._is_open:
            self.read()
        self._take_rest()

    def _take_rest(self) -> None:
        rest, self._rest = self._rest, b""
        if rest:
            self._take(rest)


class ProbeLink:
    """The connection to the probe of one process. ``take`` gets its lines."""

    def __init__(self, selector: BaseSelector, take: Callable[[list[ProbeLine]], None]) -> None:
        self.hello: Hello | None = None
        """The description of the process, once it has arrived."""
        self.uncaught: Uncaught | None = None
        """The exception that ended the program."""
        self.has_left = False
        """Whether the process exited by itself, and was not killed."""
        self.is_open = False
        self._selector = selector
        self._take = take

    def connect(self, place: Place) -> bool:
        """Connect to the probe at an address, unless connected; returns whether there is a connection now."""
        if self.is_open or self.hello is not None:
            return True
        try:
            connection = _connected(place, FOLLOW)
        except OSError:  # it does not listen yet, or not any more
            return False
        self.is_open = True
        LineReader(self._selector, connection, self._told, self._closed)
        return True

    def _closed(self) -> None:
        self.is_open = False

    def _told(self, data: bytes) -> None:
        if not data.endswith(b"\n"):  # the process died in the middle of a line
            return
        lines = decode_lines(data)
        for line in lines:
            if isinstance(line, Hello):
                self.hello = line
            elif isinstance(line, Uncaught):
                self.uncaught = line
            elif isinstance(line, Left):
                self.has_left = True
        self._take(lines)


def _connected(place: Place, word: bytes = b"") -> socket.socket:
    """Connect to a probe and send ``word``, after the token if it is reached by host and port."""
    family, address = (socket.AF_UNIX, str(place)) if isinstance(place, Path) else (socket.AF_INET, place)
    connection = socket.socket(family)
    try:
        connection.settimeout(_TO_ANSWER)
        connection.connect(address)
        token = b"" if family == socket.AF_UNIX else f"{os.environ.get(TOKEN, '')}\n".encode()
        connection.sendall(token + word)
    except OSError:
        connection.close()
        raise
    return connection


def say_token(token: str) -> None:
    """Have this process and its children send a token to the probes of other machines."""
    os.environ[TOKEN] = token


def has_token() -> bool:
    """Whether this process sends a token."""
    return bool(os.environ.get(TOKEN))


def process_at(place: Place) -> Hello | None:
    """Ask the probe at an address for its process; None if it does not reply, as without its token.

    Raises:
        OSError: nobody listens there.
    """
    with _connected(place) as visitor, visitor.makefile("rb") as lines:
        try:
            answer = decode_lines(lines.readline())
        except (OSError, msgspec.DecodeError):
            return None
    return next((line for line in answer if isinstance(line, Hello)), None)


def processes_in(folder: Path) -> list[Hello]:
    """Ask all probes that listen in a folder for their processes; remove the sockets of dead ones."""
    found = []
    for path in sockets_in(folder):
        try:
            found.append(process_at(path))
        except ConnectionRefusedError:
            path.unlink(missing_ok=True)
        except OSError:
            continue
    return [hello for hello in found if hello is not None]


def sockets_in(folder: Path) -> list[Path]:
    """The sockets of probes in a folder, and in the folders in it, each of which belongs to one command."""
    return sorted(folder.rglob("*.sock"))
