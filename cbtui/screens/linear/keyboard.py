"""The keyboard of the console for screen readers: single keys, and lines where one is asked for."""

import os
import re
import sys
import termios
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Thread

_READ_SIZE = 4096
_END = "\x04"
_SEQUENCE = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|O.)")
"""Sequences of arrows and other keys without a character; their letters must not count as keys."""


class KeyReader:
    """Reads standard input on a thread of its own; ``give`` gets each line, and None at the end.

    On a terminal each key counts as a line, and is not echoed, unless lines are wanted.
    """

    def __init__(self) -> None:
        self._descriptor = sys.stdin.fileno()
        self._is_terminal = os.isatty(self._descriptor)
        self._takes_lines = True
        self.give: Callable[[str | None], None] = lambda _: None

    @contextmanager
    def opened(self) -> Iterator[None]:
        """Read during the block; the terminal is restored at its end."""
        usual = termios.tcgetattr(self._descriptor) if self._is_terminal else None
        Thread(target=self.read, name="keyboard", daemon=True).start()
        try:
            yield
        finally:
            if usual is not None:
                termios.tcsetattr(self._descriptor, termios.TCSADRAIN, usual)

    def take_lines(self, *, wanted: bool) -> None:
        """Switch between whole lines, which the terminal echoes and edits, and single keys."""
        if self._is_terminal:
            self._takes_lines = wanted
            mode = termios.tcgetattr(self._descriptor)
            flags = termios.ICANON | termios.ECHO
            mode[tty.LFLAG] = mode[tty.LFLAG] | flags if wanted else mode[tty.LFLAG] & ~flags
            termios.tcsetattr(self._descriptor, termios.TCSADRAIN, mode)

    def read(self) -> None:
        """Read until the input ends, which ctrl+d does as well."""
        begun = ""
        while True:
            try:
                data = os.read(self._descriptor, _READ_SIZE)
            except OSError:  # the terminal is gone
                data = b""
            text = _SEQUENCE.sub("", data.decode("utf-8", "replace"))
            if self._takes_lines:
                *lines, begun = (begun + text).split("\n")
            else:
                lines = list(text)
            for line in lines:
                if line != _END:
                    self.give(line)
            if not data or _END in lines:
                self.give(None)
                return
