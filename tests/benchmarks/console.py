"""A console in a terminal of its own: keys go in, what it draws comes out, what it takes is told."""

import os
import re
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from select import select
from tempfile import TemporaryDirectory

import psutil

from tests.support.pseudo_terminal import start_in_terminal

COLUMNS, ROWS = 140, 40
QUESTION = rb"without predicting"
"""What a lesson asks before it runs can be skipped, says the window that asks."""
SKIPS = "\x1b"
"""The key for that."""
RUNS = rb"\bt (?!0\.000)\d+\.\d{3} s"
"""A time after 0 in the status line: the first callbacks have been told of."""
_PATIENCE = 60.0
"""Seconds after which what never comes is given up."""
_AT_ONCE = 1 << 16
_TAIL = 4096
"""Bytes that are kept of what was read: more than a word and the codes within it."""
_CODES = re.compile(rb"\x1b\[[0-9;?]*[a-zA-Z]")


class Console:
    """A running console, by the number of its ``process``. Not thread-safe."""

    def __init__(self, screen: int, process: int) -> None:
        self._screen = screen
        self.process = process
        self._last = b""

    def press(self, keys: str) -> None:
        """Type keys."""
        os.write(self._screen, keys.encode())

    def until(self, pattern: bytes) -> float:
        """Read until something that is drawn from now on matches; return the seconds that took.

        Raises:
            TimeoutError: it has not come in a minute.
            EOFError: the console has ended.
        """
        began = time.perf_counter()
        wanted = re.compile(pattern)
        drawn = b""
        while time.perf_counter() < began + _PATIENCE:
            drawn = drawn[-_TAIL:] + self._read(1.0)
            if wanted.search(_CODES.sub(b" ", drawn)):
                return time.perf_counter() - began
        raise TimeoutError(f"the console has not drawn {pattern.decode()} in {_PATIENCE:g} s")

    def watch(self, seconds: float) -> int:
        """Take what is drawn for so long; return how many bytes that is."""
        end = time.perf_counter() + seconds
        read = 0
        while (left := end - time.perf_counter()) > 0:
            read += len(self._read(left))
        return read

    def share_of_a_core(self, seconds: float) -> float:
        """Take what is drawn for so long; return the processor's seconds a second that drawing takes.

        Those of the console alone: neither the engine's nor the camera's.
        """
        began, spent = time.perf_counter(), self._spent()
        self.watch(seconds)
        return (self._spent() - spent) / (time.perf_counter() - began)

    @property
    def resident(self) -> int:
        """The bytes of memory that the console has."""
        return psutil.Process(self.process).memory_info().rss

    def _spent(self) -> float:
        times = psutil.Process(self.process).cpu_times()
        return times.user + times.system

    def _read(self, seconds: float) -> bytes:
        ready, _, _ = select([self._screen], [], [], seconds)
        try:
            self._last = os.read(self._screen, _AT_ONCE) if ready else b""
        except OSError as error:
            said = _CODES.sub(b"", self._last).decode(errors="replace").strip()
            raise EOFError(f"the console has ended and said: {said}") from error
        return self._last


@contextmanager
def opened(*arguments: str) -> Iterator[Console]:
    """A console that is started with these arguments, as on a machine where nobody has used it yet."""
    with TemporaryDirectory() as home:
        process, ours, theirs = start_in_terminal(("-m", "cbtui", *arguments), COLUMNS, ROWS, Path(home))
        os.close(theirs)
        console = Console(ours, process.pid)
        try:
            yield console
        finally:
            process.terminate()
            _drain(ours, process)
            os.close(ours)


@contextmanager
def lesson_opened(lesson: str) -> Iterator[Console]:
    """A console with a lesson that runs, its questions left without an answer."""
    with opened("open", lesson) as console:
        console.until(QUESTION)
        console.press(SKIPS)
        console.until(RUNS)
        yield console


def _drain(screen: int, process: "subprocess.Popen[bytes]") -> None:
    """Read what a console that ends still writes: it waits for a terminal that takes nothing."""
    end = time.monotonic() + _PATIENCE
    while process.poll() is None and time.monotonic() < end:
        ready, _, _ = select([screen], [], [], 0.05)
        try:
            if ready:
                os.read(screen, _AT_ONCE)
        except OSError:
            break
    if process.poll() is None and time.monotonic() > end:
        process.kill()
        raise TimeoutError(f"the console has not ended in {_PATIENCE:g} s")
    process.wait()
