"""A pseudo-terminal for programs: text typed at its far end reaches them as they read.

The kernel's line discipline works as for any terminal: it collects lines, or passes on each key if a program
has set that mode.
"""

import fcntl
import os
import re
import select
import struct
import termios

from sim.engine.commands import END_OF_INPUT, INTERRUPT
from sim.trace.events import Reading

# Kept from before a clock, or the model's terminal, replaces them.
_read = os.read
_select = select.select

_ROWS, _COLUMNS = 24, 80
_LINE = re.compile(r"[^\n]*\n|[^\n]+")
_KEY = re.compile(r"\x1b\[[0-9;]*[A-Za-z~]|\x1bO.|.", re.DOTALL)
"""The text of one key: a character, or a sequence such as that of an arrow key."""
_LONGEST = 4000
"""Characters of a line that are sent at once; the kernel's buffer has 4,095 bytes."""


class PseudoTerminal:
    """``near`` is the descriptor that programs read from. Not thread-safe.

    Where the system has no pseudo-terminals (no ``/dev/pts``), it is a pipe that passes on lines.
    """

    def __init__(self) -> None:
        try:
            self._far: int | None
            self._far, self.near = os.openpty()
            fcntl.ioctl(self.near, termios.TIOCSWINSZ, struct.pack("HHHH", _ROWS, _COLUMNS, 0, 0))
        except OSError:
            self.near, self._far = os.pipe()
        self._is_terminal = os.isatty(self.near)
        os.set_blocking(self._far, False)
        self._identity = self._identified(os.fstat(self.near))
        self._text = ""
        self._place = 0
        self._line_begun = False

    def type(self, text: str) -> str:
        """Queue text for readers; return it as it is shown, with dots for a password."""
        self._text = self._text[self._place :] + text
        self._place = 0
        return re.sub(r"[^\n]", "•", text) if self.mode() is Reading.SECRET else text

    def interrupts(self, text: str) -> bool:
        """Return whether text, typed now, would interrupt the program that has the terminal."""
        if not self._is_terminal:
            return INTERRUPT in text
        return INTERRUPT in text and bool(termios.tcgetattr(self.near)[3] & termios.ISIG)

    @property
    def has_more(self) -> bool:
        """Whether typed text waits to be sent."""
        return self._place < len(self._text)

    def feed(self, *, is_last: bool) -> bool:
        """Send the next key or line unless one is unread; return whether there is something to read.

        Queued keys are sent one by one: a program that reads one and then drops its other input, as
        ``tty.setraw`` does, would lose them. ``is_last``: no more will be typed.
        """
        readable = self.has_unread
        while not readable and self.has_more:
            takes_keys = self.mode().takes_keys
            found = (_KEY if takes_keys else _LINE).match(self._text, self._place, self._place + _LONGEST)
            assert found is not None
            self._place = found.end()
            # The kernel takes a moment to pass it on.
            readable = not self.interrupts(found[0]) if takes_keys else found[0].endswith("\n")
            self._line_begun = not (takes_keys or readable)
            self.send(found[0])
        if self._line_begun and not readable and is_last:
            self._line_begun = False
            if self._is_terminal:  # the content of a pipe can be read without an end
                self.end()
            readable = self.has_unread
        return readable

    @property
    def has_unread(self) -> bool:
        """Whether sent text has not been read."""
        return bool(_select([self.near], [], [], 0)[0])

    def is_meant_by(self, found: os.stat_result) -> bool:
        """Return whether an open file, by its status, is this terminal."""
        return self._identified(found) == self._identity

    def _identified(self, found: os.stat_result) -> tuple[int, int]:
        return (0, found.st_rdev) if self._is_terminal else (found.st_dev, found.st_ino)

    def end(self) -> None:
        """Submit the unfinished line, or send the end of the input."""
        if self._is_terminal:
            self.send(END_OF_INPUT)
        elif self._far is not None:
            os.close(self._far)
            self._far = None

    def send(self, text: str) -> None:
        """Send text at once."""
        if self._far is not None:
            os.write(self._far, text.encode(errors="replace"))
        self.drop_echo()

    def drop_echo(self) -> None:
        """Empty the far end's echo, which would fill its buffer; the trace has it as ``Typed``."""
        try:
            while self._is_terminal and self._far is not None and _read(self._far, _LONGEST):
                pass
        except BlockingIOError:
            return

    def mode(self) -> Reading:
        """Return how a program reads, by the modes of the terminal."""
        if not self._is_terminal:
            return Reading.LINES
        local = termios.tcgetattr(self.near)[3]
        if local & termios.ICANON:
            return Reading.LINES if local & termios.ECHO else Reading.SECRET
        return Reading.KEYS if local & termios.ISIG else Reading.RAW
