"""The terminal of a run's programs on real rclpy: who reads from it, and what is typed there."""

import os
import platform
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

from sim.engine.commands import END_OF_INPUT
from sim.engine.setup import Keyboard
from sim.engine.stdio.pseudo_terminal import PseudoTerminal
from sim.trace.events import AnyEvent, KeyboardAsked, Reading, Typed

_READ = {"x86_64": "0", "aarch64": "63"}.get(platform.machine(), "")
"""The number of the system call ``read``."""
_PERIOD = 0.05
"""Seconds between two looks at programs while nothing is to be handed on."""
_BETWEEN = 0.3
"""Seconds for which a program that has read is taken to read on."""


class RealKeyboard:
    """Programs read from ``near``. ``record`` takes the events of who waits for keys, and what is typed.

    That a program waits is seen from outside: one of its threads is in a system call that reads from the
    terminal, or the program has asked the terminal for single keys.
    """

    def __init__(self, record: Callable[[AnyEvent], None], keyboard: Keyboard, scheduled: int) -> None:
        self._record = record
        self._is_last = keyboard is Keyboard.NOBODY and not scheduled
        self._ends_after = scheduled if keyboard is Keyboard.NOBODY else None
        self._pair = PseudoTerminal()
        self._asked = Reading.NOTHING
        self._look_at = self._read_at = 0.0
        self.near = self._pair.near

    def type(self, text: str, *, ends: bool = False, scheduled: bool = False) -> None:
        """Type text; ``ends``: it is the last."""
        if scheduled and self._ends_after is not None:
            self._ends_after -= 1
            ends = ends or not self._ends_after
        self._is_last = self._is_last or ends
        if text:
            self._record(Typed(0, self._pair.type(text)))

    def interrupts(self, text: str) -> bool:
        """Whether text, typed now, would interrupt the programs."""
        return self._pair.interrupts(text)

    def look(self, programs: Mapping[int, str]) -> int:
        """Hand on what was typed to the program that waits for it.

        ``programs`` are the names of those that may read, by their numbers in the operating system. Returns
        the number of one that has begun to wait, 0 for none.
        """
        now = time.monotonic()
        if now < self._look_at:
            return 0
        self._pair.drop_echo()
        mode = self._pair.mode()
        reader = next((each for each in programs if _reads_terminal(each, self.near)), 0)
        if not reader and mode.takes_keys:
            reader = next(iter(programs), 0)
        if reader and not self._pair.feed(is_last=self._is_last) and self._is_last and not mode.takes_keys:
            self._pair.send(END_OF_INPUT)
        self._look_at = now + (0 if self._pair.has_more else _PERIOD)
        if reader:
            self._read_at = now
        return self._note(mode if reader else Reading.NOTHING, reader, programs)

    def _note(self, asked: Reading, reader: int, programs: Mapping[int, str]) -> int:
        is_between = not reader and programs and time.monotonic() < self._read_at + _BETWEEN
        if asked is self._asked or is_between:
            return 0
        self._asked = asked
        self._record(KeyboardAsked(0, asked, programs.get(reader, "")))
        return reader


def _reads_terminal(process: int, near: int) -> bool:
    """Whether a thread of a process is in a system call that reads from the terminal."""
    terminal = os.ttyname(near)
    with suppress(OSError):
        for call in Path(f"/proc/{process}/task").glob("*/syscall"):
            with suppress(OSError):
                number, *arguments = call.read_text().split()
                if number == _READ:
                    found = Path(f"/proc/{process}/fd/{int(arguments[0], 16)}").readlink()
                    return str(found) in (terminal, "/dev/tty")
    return False
