"""The programs of a run on real rclpy: processes of their own, each with the probe on its path."""

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from selectors import EVENT_READ, BaseSelector
from typing import IO

from sim.real.wire import Hello, ProbeLine, Uncaught, decode_lines

ON_PATH = Path(__file__).parents[1] / "probes" / "on_path"
"""The folder that a probed program has on its path."""
PROBE_FOLDER = "CBTUI_PROBE"
"""The environment variable that tells a probe in which folder it is to listen."""
_BOOTSTRAPPED = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
"""The environment variable by which ROS's wheels know that they have found their libraries."""
_LOG_BEGINS, _LOG_ENDS = "\x1e", "\x1f"
"""What rclpy's log lines stand between on the terminal: the probe tells of them too."""
_CHUNK = 1 << 16
"""Bytes that are read at once."""


def environment(python: str, folder: Path, domain: int) -> dict[str, str]:
    """The environment of a run's programs: probed at sockets in ``folder``, in a ROS domain of their own."""
    inherited = dict(os.environ)
    if python != sys.executable and inherited.pop(_BOOTSTRAPPED, ""):
        # The wheels of this Python's ROS have put their libraries there, which are not those of another one.
        libraries = inherited.pop("LD_LIBRARY_PATH", "").split(os.pathsep)
        others = [each for each in libraries if not Path(each).is_relative_to(sys.prefix)]
        inherited |= {"LD_LIBRARY_PATH": os.pathsep.join(others)} if others else {}
    path = os.pathsep.join(filter(None, (str(ON_PATH), os.environ.get("PYTHONPATH"))))
    return {
        **inherited,
        "PYTHONPATH": path,
        "PYTHONUNBUFFERED": "1",
        PROBE_FOLDER: str(folder),
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "RCUTILS_COLORIZED_OUTPUT": "0",
        "RCUTILS_CONSOLE_OUTPUT_FORMAT": f"{_LOG_BEGINS}{{message}}{_LOG_ENDS}",
    }


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


class Program:
    """One program that was started. ``take`` gets what its probe sends, ``show`` the lines that it prints.

    ``number`` tells it from the others of the run, 0 for an only one.
    """

    def __init__(
        self,
        selector: BaseSelector,
        command: Sequence[str],
        environment: Mapping[str, str],
        number: int,
        take: Callable[[list[ProbeLine], int], None],
        show: Callable[[str, bool, int], None],
    ) -> None:
        self.number = number
        self.name = Path(command[-1] if len(command) == 1 else command[1]).name
        self.uncaught: Uncaught | None = None
        self.hello: Hello | None = None
        self._selector = selector
        self._take = take
        self._show = show
        self._open = 2
        self._socket: socket.socket | None = None
        self._process = subprocess.Popen(
            command,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            bufsize=0,
        )
        for stream, error in ((self._process.stdout, False), (self._process.stderr, True)):
            assert stream is not None
            LineReader(selector, stream, lambda data, error=error: self._printed(data, error), self._one_less)  # type: ignore[misc]

    @property
    def pid(self) -> int:
        """Its number in the operating system."""
        return self._process.pid

    @property
    def has_ended(self) -> bool:
        """Whether it is over, and all that it said has been taken."""
        return self._open == 0 and self._process.poll() is not None

    @property
    def status(self) -> int:
        """Its exit code once it has ended; negative for the signal that killed it."""
        return self._process.returncode

    def connect(self, path: Path) -> None:
        """Listen to its probe; nothing if it is listened to, or does not listen itself yet."""
        if self._socket is not None:
            return
        connection = socket.socket(socket.AF_UNIX)
        try:
            connection.connect(str(path))
        except OSError:
            connection.close()
            return
        self._socket = connection
        self._open += 1
        LineReader(self._selector, connection, self._told, self._one_less)

    def type(self, text: str, *, ends: bool) -> None:
        """Have it read a text from its standard input; with ``ends``, no more will come."""
        stdin = self._process.stdin
        assert stdin is not None
        with suppress(OSError, ValueError):
            stdin.write(text.encode())
            if ends:
                stdin.close()

    def signal(self, number: signal.Signals) -> None:
        """Send it, and what it started, a signal."""
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, number)

    def _one_less(self) -> None:
        self._open -= 1

    def _told(self, data: bytes) -> None:
        lines = decode_lines(data)
        for line in lines:
            if isinstance(line, Hello):
                self.hello = line
            elif isinstance(line, Uncaught):
                self.uncaught = line
        self._take(lines, self.number)

    def _printed(self, data: bytes, error: bool) -> None:
        text = data.decode(errors="replace")
        if error and self.hello is not None:
            text = _without_log(text)
        for line in text.replace(_LOG_BEGINS, "").replace(_LOG_ENDS, "").splitlines():
            self._show(line, error, self.number)


def _without_log(text: str) -> str:
    """What a program wrote besides its log; a line of the log is written at once."""
    kept, _, rest = text.partition(_LOG_BEGINS)
    while rest:
        _, _, rest = rest.partition(_LOG_ENDS)
        more, _, rest = rest.removeprefix("\n").partition(_LOG_BEGINS)
        kept += more
    return kept
