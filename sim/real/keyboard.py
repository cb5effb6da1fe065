"""The pseudo-terminal of a run's programs on real rclpy: which of them reads, and what is typed."""

import os
import platform
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

from sim.engine.setup import Keyboard
from sim.engine.stdio.pseudo_terminal import PseudoTerminal
from sim.trace.events import AnyEvent, KeyboardAsked, Reading, Typed

_READ = {"x86_64": "0", "aarch64": "63"}.get(platform.machine(), "")
"""The number of the system call ``read``."""
_SELECTS = {"x86_64": ("7", "23", "232", "270", "271", "281"), "aarch64": ("22", "72", "73")}
"""The numbers of ``poll``, ``select`` and similar system calls."""
_UNSEEN = 1.0
"""Seconds after which typed keys go to a program that wants keys but was not seen to wait for them."""
_PERIOD = 0.05
"""Seconds between two looks at the programs while no input is pending."""
_BETWEEN = 0.3
"""Seconds for which a program that has read counts as reading still."""


class RealKeyboard:
    """Gives typed text to the program that waits for it. ``record`` gets the events about reading and typing.

    Programs read from the descriptor ``near``. A program counts as waiting if one of its threads is in a
    system call that reads from the terminal, or if it has set the terminal to single keys.
    """

    def __init__(self, record: Callable[[AnyEvent], None], keyboard: Keyboard, scheduled: int) -> None:
        self._record = record
        self._is_last = keyboard is Keyboard.NOBODY and not scheduled
        self._ends_after = scheduled if keyboard is Keyboard.NOBODY else None
        self._pair = PseudoTerminal()
        self._asked = Reading.NOTHING
        self._look_at = self._read_at = 0.0
        self._fed: tuple[int, int] | None = None
        """The program that got the last input, and how many of its reads had ended by then."""
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
        """Whether typing this text now interrupts the programs."""
        return self._pair.interrupts(text)

    def look(self, programs: Mapping[int, str]) -> int:
        """Write typed text to the program that waits for it.

        ``programs`` has the names of the programs that may read, by process id. Returns the process id of a
        program that has begun to wait, 0 for none.
        """
        now = time.monotonic()
        if now < self._look_at:
            return 0
        self._pair.drop_echo()
        # In this order: who reads now, though all had been read before, reads on.
        has_unread, mode = self._pair.has_unread, self._pair.mode()
        reader = next((each for each in programs if _reads(each, self.near, mode)), 0)
        if reader:
            self._read_at = now
        elif mode.takes_keys and now > self._read_at + _UNSEEN:
            reader = next(iter(programs), 0)  # it waits in a way that cannot be seen
        self._look_at = now + (0 if self._pair.has_more else _PERIOD)
        if self._note(mode if reader else Reading.NOTHING, reader, programs):
            return reader
        if reader and not has_unread and self._fed != (reader, reads := _ended_reads(reader)):
            fed = self._pair.feed(is_last=self._is_last)
            self._fed = (reader, reads) if fed else None
            if self._is_last and not fed and not mode.takes_keys:
                self._pair.end()
        return 0

    def _note(self, asked: Reading, reader: int, programs: Mapping[int, str]) -> bool:
        """Record how a program reads, if that has changed; returns whether it has begun to read."""
        is_between = not reader and programs and time.monotonic() < self._read_at + _BETWEEN
        if asked is self._asked or is_between:
            return False
        self._asked = asked
        self._record(KeyboardAsked(0, asked, programs.get(reader, "")))
        return bool(reader)


def _ended_reads(process: int) -> int:
    """The number of a process's finished reads; input reaches a reader a little after it was written.

    Where the system does not give it, a number that changes every 50 ms.
    """
    try:
        told = Path(f"/proc/{process}/io").read_text()
    except OSError:
        return time.monotonic_ns() // 50_000_000
    return next(int(line.split()[1]) for line in told.splitlines() if line.startswith("syscr"))


def _reads(process: int, near: int, mode: Reading) -> bool:
    """Whether a thread of a process is in a system call that reads from the terminal, or polls it.

    A program that changes the terminal's mode for each key loses keys that are typed in between.
    """
    terminal = os.ttyname(near) if os.isatty(near) else str(Path(f"/proc/self/fd/{near}").readlink())
    for call in Path(f"/proc/{process}/task").glob("*/syscall"):
        with suppress(OSError):
            number, *arguments = call.read_text().split()
            if number == _READ:
                found = Path(f"/proc/{process}/fd/{int(arguments[0], 16)}").readlink()
                if str(found) in (terminal, "/dev/tty"):
                    return True
            is_main = call.parent.name == str(process)
            if mode.takes_keys and is_main and number in _SELECTS.get(platform.machine(), ()):
                return True
    return False
