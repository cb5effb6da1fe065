"""Receives ``ros2`` lines from other terminals over a local socket named by this process's number.

The socket lies in the user's runtime folder, which no other user may enter. One connection carries one line:
the client sends its words and perhaps an interrupt, and receives the line's output and exit status.
"""

import os
import socket
import stat
import tempfile
import threading
from collections.abc import Callable, Iterable
from contextlib import suppress
from multiprocessing.connection import Client, Connection
from pathlib import Path
from queue import SimpleQueue
from typing import TypeAlias

import msgspec

from sim.engine.commands import Command, InterruptLine, RunLine
from sim.trace.events import AnyEvent, LineEnded, LineId, LineSaid

_FIRST_NUMBER = 1_000_000
"""The first number for lines from other terminals; those of the run itself are smaller."""


class LineRequest(msgspec.Struct, frozen=True, tag="ask"):
    """Runs a line; with ``asks_who`` the run says first which one it is."""

    text: str
    asks_who: bool = False


class InterruptRequest(msgspec.Struct, frozen=True, tag="interrupt"):
    """Ends the line as Ctrl-C would."""


class LineOutput(msgspec.Struct, frozen=True, tag="said"):
    """Output of the line."""

    text: str
    error: bool


class LineResult(msgspec.Struct, frozen=True, tag="done"):
    """The line's exit status; None: the run ended before it, or before the line was given."""

    status: int | None


ClientMessage: TypeAlias = LineRequest | InterruptRequest
ServerMessage: TypeAlias = LineOutput | LineResult

_encode = msgspec.msgpack.Encoder().encode
_decode_question: Callable[[bytes], ClientMessage] = msgspec.msgpack.Decoder(ClientMessage).decode
_decode_answer: Callable[[bytes], ServerMessage] = msgspec.msgpack.Decoder(ServerMessage).decode


class UnusableFolderError(OSError):
    """The runtime folder cannot be used; the text says which folder, and why."""


def runtime_folder() -> Path:
    """The folder of the sockets, created for its owner only if it is missing.

    Raises:
        UnusableFolderError: it cannot be created, or other users have access to it.
    """
    above = os.environ.get("XDG_RUNTIME_DIR") or tempfile.gettempdir()
    folder = Path(above) / f"cbtui-{os.getuid()}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        status = folder.lstat()
    except OSError as error:
        raise UnusableFolderError(f"{folder} cannot be made: {error.strerror}") from error
    if not stat.S_ISDIR(status.st_mode):
        raise UnusableFolderError(f"{folder} is not a folder")
    if status.st_uid != os.getuid():
        raise UnusableFolderError(f"{folder} belongs to another user")
    if status.st_mode & 0o077:
        raise UnusableFolderError(f"{folder} is open to other users, until chmod 700 closes it")
    return folder


class ControlServer:
    """Receives lines for one run; thread-safe. ``send`` commands its engine, ``take`` gets its events.

    ``title`` is the run's name for the person who sent a line.
    """

    def __init__(self, send: Callable[[Command], None], title: str = "") -> None:
        self._send = send
        self._title = title
        self._lock = threading.Lock()
        self._next = _FIRST_NUMBER
        self._answers: dict[LineId, SimpleQueue[ServerMessage]] = {}
        self._over = False
        self._socket: socket.socket | None = None
        self._path = Path()

    def start(self) -> str | None:
        """Start listening; returns a sentence if the socket cannot be opened."""
        try:
            self._path = runtime_folder() / f"{os.getpid()}.sock"
            self._path.unlink(missing_ok=True)
            self._socket = listening = socket.socket(socket.AF_UNIX)
            listening.bind(str(self._path))
            listening.listen()
        except OSError as error:
            self.stop()
            return (
                f"lines of cbtui ros2 do not reach this run: {error.strerror or error}; "
                "set XDG_RUNTIME_DIR to a folder of your own"
            )
        threading.Thread(target=self._accept, args=(listening,), name="control", daemon=True).start()
        return None

    def take(self, events: Iterable[AnyEvent]) -> None:
        """Forward the output of lines to the clients that sent them."""
        if not self._answers:
            return
        for event in events:
            match event:
                case LineSaid(line=line, text=text, error=error):
                    self._answer(line, LineOutput(text, error))
                case LineEnded(line=line, status=status):
                    self._answer(line, LineResult(status))

    def over(self) -> None:
        """Tell all clients, and those that come until ``stop``, that the run is over."""
        with self._lock:
            self._over = True
            for answers in self._answers.values():
                answers.put(LineResult(None))

    def stop(self) -> None:
        """Stop listening and tell all clients that the run is over."""
        if self._socket is not None:
            listening, self._socket = self._socket, None
            with suppress(OSError):
                listening.shutdown(socket.SHUT_RDWR)  # wakes the thread that accepts
            listening.close()
            self._path.unlink(missing_ok=True)
        self.over()

    def _answer(self, line: LineId, answer: ServerMessage) -> None:
        queue = self._answers.get(line)
        if queue is not None:
            queue.put(answer)

    def _accept(self, listening: socket.socket) -> None:
        while True:
            try:
                accepted, _ = listening.accept()
            except OSError:
                return
            connection = Connection(accepted.detach())
            threading.Thread(target=self._serve, args=(connection,), name="control", daemon=True).start()

    def _serve(self, connection: Connection) -> None:
        with connection, suppress(OSError, EOFError, msgspec.DecodeError):
            question = _decode_question(connection.recv_bytes())
            if isinstance(question, LineRequest):
                if question.asks_who:
                    who = f"cbtui: process {os.getpid()} answers: {self._title}; --engine chooses another one"
                    connection.send_bytes(_encode(LineOutput(who, error=True)))
                self._carry_out(connection, question.text)

    def _carry_out(self, connection: Connection, text: str) -> None:
        with self._lock:
            line = self._next
            self._next += 1
            answers = self._answers[line] = SimpleQueue()
            if self._over:
                answers.put(LineResult(None))
        self._send(RunLine(line, text))
        threading.Thread(target=self._listen, args=(connection, line), name="control", daemon=True).start()
        try:
            while not isinstance(answer := answers.get(), LineResult):
                connection.send_bytes(_encode(answer))
            connection.send_bytes(_encode(answer))
        finally:
            with self._lock:
                del self._answers[line]

    def _listen(self, connection: Connection, line: LineId) -> None:
        """Interrupt the line when its client asks for it or disconnects."""
        # Closing a connection while another thread reads from it raises a TypeError there.
        with suppress(OSError, EOFError, TypeError, msgspec.DecodeError):
            _decode_question(connection.recv_bytes())
        self._send(InterruptLine(line))


class NoEngine(LookupError):  # noqa: N818 - the sentence it carries is what a reader sees
    """No run listens on a socket; the text says which one was looked for, and where."""


def connect(process: int | None) -> Connection:
    """Connect to the run of that process number, or to the one started last.

    Raises:
        NoEngine: no such run listens.
    """
    try:
        folder = runtime_folder()
    except UnusableFolderError as error:
        raise NoEngine(f"no run can be looked for ({error})") from error
    for path in _sockets(folder):
        if process is not None and path.stem != str(process):
            continue
        try:
            return Client(str(path), family="AF_UNIX")
        except ConnectionRefusedError:
            path.unlink(missing_ok=True)  # left behind by a process that was killed
        except OSError:
            continue
    raise NoEngine(f"no run{'' if process is None else f' of process {process}'} listens in {folder}")


def several_listen() -> bool:
    """Whether more than one run listens."""
    found = 0
    with suppress(UnusableFolderError):
        for path in _sockets(runtime_folder()):
            with suppress(OSError), Client(str(path), family="AF_UNIX"):
                found += 1
    return found > 1


def _sockets(folder: Path) -> list[Path]:
    """The existing sockets, newest first."""
    made = dict[Path, float]()
    for path in folder.glob("*.sock"):
        with suppress(FileNotFoundError):  # its run has just ended
            made[path] = path.stat().st_mtime
    return sorted(made, key=made.__getitem__, reverse=True)


class RemoteLine:
    """A line that runs in another process, which says first which one it is if ``asks_who``."""

    def __init__(self, connection: Connection, text: str, *, asks_who: bool = False) -> None:
        self._connection = connection
        connection.send_bytes(_encode(LineRequest(text, asks_who)))

    def next_answer(self) -> ServerMessage:
        """Wait for its next output or its result; ``LineResult(None)`` if the run ends first."""
        try:
            return _decode_answer(self._connection.recv_bytes())
        except (OSError, EOFError):
            return LineResult(None)

    def interrupt(self) -> None:
        """End the line as Ctrl-C would."""
        with suppress(OSError):
            self._connection.send_bytes(_encode(InterruptRequest()))
