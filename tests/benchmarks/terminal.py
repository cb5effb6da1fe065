"""What the console sends to a terminal while a lesson runs: that must fit through ssh."""

import fcntl
import os
import pty
import struct
import subprocess
import sys
import termios
import time
from io import FileIO
from tempfile import TemporaryDirectory

_COLUMNS, _ROWS = 140, 40
_SHOWN = b"LIVE"
_TERMINAL = {"TERM": "xterm-256color", "COLORTERM": "truecolor", "LC_ALL": "C.UTF-8"}


def sent(tenths: int, lesson: str = "split-groups") -> float:
    """The kB a second that the console sends in so many tenths of one, its lesson's service called."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", _ROWS, _COLUMNS, 0, 0))
    command = [sys.executable, "-m", "cbtui", "open", lesson]
    with TemporaryDirectory() as home:
        environment = os.environ | _TERMINAL | {"HOME": home, "XDG_CONFIG_HOME": home}
        console = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, env=environment)
        os.close(theirs)
        with console, os.fdopen(ours, "r+b", buffering=0) as screen:
            try:
                _wait_for_the_lesson(screen)
                screen.write(b"s")
                return _read(screen, tenths / 10) / (tenths / 10) / 1e3
            finally:
                console.terminate()
                console.wait()


def _wait_for_the_lesson(screen: FileIO) -> None:
    drawn = b""
    while _SHOWN not in drawn:
        drawn += screen.read(1 << 16)


def _read(screen: FileIO, seconds: float) -> int:
    """Read for so long; return how many bytes came."""
    end = time.monotonic() + seconds
    read = 0
    while time.monotonic() < end:
        read += len(screen.read(1 << 16))
    return read
