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

# Kept from before a clock, or a terminal of the model's, puts its own in their place.
_read = os.read
_select = select.select

_ROWS, _COLUMNS = 24, 80
_LINE = re.compile(r"[^\n]*\n|[^\n]+")
_KEY = re.compile(r"\x1b\[[0-9;]*[A-Za-z~]|\x1bO.|.", re.DOTALL)
"""What one press of a key sends: a character, or a sequence such as that of an arrow key."""
_LONGEST = 4000
"""Characters of a line that the kernel is handed at once; it holds no more than 4,095 bytes."""


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
        """Keep text for those who read; returns it as it is to be shown: what is secret is dots."""
        self._text = self._text[self._place :] + text
        self._place = 0
        return re.sub(r"[^\n]", "•", text) if self.mode() is Reading.SECRET else text

    def interrupts(self, text: str) -> bool:
        """Whether text, typed now, would interrupt the program that has the terminal."""
        if not self._is_terminal:
            return INTERRUPT in text
        return INTERRUPT in text and bool(termios.tcgetattr(self.near)[3] & termios.ISIG)

    @property
    def has_more(self) -> bool:
        """Whether something has been typed that has not been handed on."""
        return self._place < len(self._text)

    def feed(self, *, is_last: bool) -> bool:
        """Hand on the next key or line, unless one has yet to be read; whether there is something to be read.

        Keys that wait are handed on one by one, as nobody presses two at once: a program that reads one, and
        then forgets what else it was sent, as ``tty.setraw`` does, would lose the others.
        ``is_last``: no more will be typed.
        """
        readable = self.has_unread
        while not readable and self.has_more:
            takes_keys = self.mode().takes_keys
            found = (_KEY if takes_keys else _LINE).match(self._text, self._place, self._place + _LONGEST)
            assert found is not None
            self._place = found.end()
            # The system takes a moment to hand it on.
            readable = not self.interrupts(found[0]) if takes_keys else found[0].endswith("\n")
            self._line_begun = not (takes_keys or readable)
            self.send(found[0])
        if self._line_begun and not readable and is_last:
            self._line_begun = False
            if self._is_terminal:  # what lies in a pipe can be read as it is
                self.end()
            readable = self.has_unread
        return readable

    @property
    def has_unread(self) -> bool:
        """Whether something has been handed on that has not been read."""
        return bool(_select([self.near], [], [], 0)[0])

    def is_meant_by(self, found: os.stat_result) -> bool:
        """Whether an open file, by its status, is this terminal."""
        return self._identified(found) == self._identity

    def _identified(self, found: os.stat_result) -> tuple[int, int]:
        return (0, found.st_rdev) if self._is_terminal else (found.st_dev, found.st_ino)

    def end(self) -> None:
        """Hand on what is typed so far, or the end of the input."""
        if self._is_terminal:
            self.send(END_OF_INPUT)
        elif self._far is not None:
            os.close(self._far)
            self._far = None

    def send(self, text: str) -> None:
        """Hand text on at once."""
        if self._far is not None:
            os.write(self._far, text.encode(errors="replace"))
        self.drop_echo()

    def drop_echo(self) -> None:
        """Keep the far end from filling up: what it echoes, the trace tells as ``Typed``."""
        try:
            while self._is_terminal and self._far is not None and _read(self._far, _LONGEST):
                pass
        except BlockingIOError:
            return

    def mode(self) -> Reading:
        """How a program reads by the modes of the terminal."""
        if not self._is_terminal:
            return Reading.LINES
        local = termios.tcgetattr(self.near)[3]
        if local & termios.ICANON:
            return Reading.LINES if local & termios.ECHO else Reading.SECRET
        return Reading.KEYS if local & termios.ISIG else Reading.RAW
