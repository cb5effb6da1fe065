"""A console in a pseudo-terminal: keys go in, what it draws comes out, and what it leaves behind shows."""

import os
import re
import subprocess
import termios
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from select import select
from typing import Any

from tests.support.processes import descendants
from tests.support.pseudo_terminal import start_in_terminal

_PATIENCE = 60.0
"""Seconds after which what never comes is given up."""
_LAST = 4000
_MODE = re.compile(rb"\x1b\[\?(\d+)([hl])")
_CODE = re.compile(rb"\x1b\[[0-9;?<>]*[a-zA-Z]")
_KEYBOARD = re.compile(rb"\x1b\[([<>])[0-9;]*u")


class TerminalConsole:
    """A running console; ``screen`` is the far end of its terminal, ``drawn`` all that it ever drew."""

    def __init__(self, process: "subprocess.Popen[bytes]", screen: int, terminal: int) -> None:
        self.process = process
        self.drawn = b""
        self._screen = screen
        self.terminal = terminal
        self._seen = 0
        self._closed = False
        self._settings = self.settings()

    def press(self, keys: str) -> None:
        """Type keys."""
        os.write(self._screen, keys.encode())

    def until(self, text: str) -> None:
        """Read until a text is drawn that was not waited for before."""
        end = time.monotonic() + _PATIENCE
        while (place := self.drawn.find(text.encode(), self._seen)) < 0:
            assert time.monotonic() < end, f"no {text!r} in {self.said()}"
            self._read()
        self._seen = place + len(text)

    def read_for(self, seconds: float) -> None:
        """Read what is drawn, for so long."""
        end = time.monotonic() + seconds
        self._read()
        while time.monotonic() < end and self.process.poll() is None:
            self._read()

    def ended(self) -> int:
        """Read to the end; return the exit code."""
        end = time.monotonic() + _PATIENCE
        while self.process.poll() is None:
            assert time.monotonic() < end, "the console does not end"
            self._read()
        while self._read():  # what was said last, bit by bit
            pass
        return self.process.returncode

    def said(self) -> str:
        """What was drawn last, without codes."""
        return _CODE.sub(b" ", self.drawn[-_LAST:]).decode(errors="replace")

    def close_window(self) -> None:
        """Close the terminal's window: there is nothing to read from or to draw to any more."""
        if not self._closed:
            self._closed = True
            os.close(self._screen)

    def started(self) -> list[int]:
        """The processes that it started, and that those started."""
        return descendants(self.process.pid)

    def settings(self) -> list[Any]:
        """How the terminal is set: echo, line by line or key by key, ..."""
        return termios.tcgetattr(self.terminal)

    def left_on(self) -> set[str]:
        """What the console has switched in the terminal, and not back."""
        modes = {int(number): switch == b"h" for number, switch in _MODE.findall(self.drawn)}
        shown = modes.pop(25, True)
        left = {f"mode {number}" for number, on in modes.items() if on and number != _WRAPS}
        keyboard = list(_KEYBOARD.findall(self.drawn))
        left |= set() if shown else {"no cursor"}
        left |= {"keyboard"} if keyboard.count(b">") != keyboard.count(b"<") else set()
        return left | (set() if self.settings() == self._settings else {"settings"})

    def _read(self) -> bool:
        """Take in what was drawn, for a moment; whether there was anything."""
        if self._closed:
            time.sleep(0.01)
            return False
        ready, _, _ = select([self._screen], [], [], 0.1)
        if ready:
            self.drawn += os.read(self._screen, 1 << 16)
        return bool(ready)


_WRAPS = 7
"""The mode that a terminal begins with: lines that are too long go on below."""


@contextmanager
def opened(
    columns: int,
    rows: int,
    home: Path,
    *words: str,
    program: Sequence[str] = ("-m", "cbtui"),
    has_job_control: bool = True,
) -> Iterator[TerminalConsole]:
    """A console in a terminal of this size, for somebody who has not used it yet.

    ``words`` are of its command line, ``program`` is what Python gets to run it.
    """
    process, screen, terminal = start_in_terminal(
        (*program, *words), columns, rows, home, has_job_control=has_job_control
    )
    console = TerminalConsole(process, screen, terminal)
    try:
        yield console
    finally:
        process.kill()
        process.wait()
        console.close_window()
        os.close(terminal)
