"""Standard input as the terminal of a run's programs: typed text, or the content of a pipe."""

import os
import select
import signal
import sys
import termios
import threading
from codecs import getincrementaldecoder
from collections.abc import Callable, Iterable
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

from sim.engine.commands import END_OF_INPUT, INTERRUPT, TerminalInput
from sim.trace.events import AnyEvent, KeyboardAsked, Reading

_READ_SIZE = 4096


class StandardInput:
    """Forwards input to a run once a program waits for it; earlier input is not read.

    The terminal is in the mode that the program asked for; in raw mode a second Ctrl-C in a row ends the run.
    ``give`` is called on a thread of its own.
    """

    def __init__(self, give: Callable[[TerminalInput], None]) -> None:
        self._give = give
        self._opened = ExitStack()
        self._descriptor = _descriptor(self._opened)
        self.is_terminal = os.isatty(self._descriptor)
        self._usual: list[Any] = termios.tcgetattr(self._descriptor) if self.is_terminal else []
        self._reads = Reading.NOTHING
        self._over, self._end = os.pipe()
        self._reader = threading.Thread(target=self._read, name="standard-input", daemon=True)

    def follow(self, events: Iterable[AnyEvent]) -> None:
        """Follow the programs' requests for keyboard input."""
        for event in events:
            if isinstance(event, KeyboardAsked):
                self._put_in_mode(event.reads)
                if self._reader.ident is None:
                    self._reader.start()

    def close(self) -> None:
        """Stop reading, and restore the terminal."""
        self._put_in_mode(Reading.NOTHING)
        os.close(self._end)
        if self._reader.ident is not None:
            self._reader.join()
        os.close(self._over)
        self._opened.close()

    def _put_in_mode(self, reads: Reading) -> None:
        before, self._reads = self._reads, reads
        if not self.is_terminal or before is reads:
            return
        modes: list[Any] = [*self._usual[:6], [*self._usual[6]]]
        if reads is Reading.SECRET:
            modes[3] &= ~termios.ECHO
        elif reads.takes_keys:
            modes[0] &= ~(termios.ICRNL | termios.IXON)
            modes[3] &= ~(termios.ECHO | termios.ICANON | termios.IEXTEN)
            modes[6][termios.VMIN], modes[6][termios.VTIME] = 1, 0
            if reads is Reading.RAW:
                modes[3] &= ~termios.ISIG
        with suppress(termios.error):  # the terminal is gone
            termios.tcsetattr(self._descriptor, termios.TCSANOW, modes)

    def _read(self) -> None:
        decoder = getincrementaldecoder("utf-8")("replace")
        latest = ""
        while self._over not in select.select([self._descriptor, self._over], [], [])[0]:
            try:
                data = os.read(self._descriptor, _READ_SIZE)
            except OSError:  # the terminal is gone
                data = b""
            text = decoder.decode(data, final=not data)
            goes_on = bool(data) or (self.is_terminal and not self._reads.takes_keys)
            if text == latest == INTERRUPT:
                os.kill(os.getpid(), signal.SIGINT)  # handled on the main thread
            latest = text
            self._give(TerminalInput(text if data or not goes_on else END_OF_INPUT, ends=not goes_on))
            if not goes_on:
                return


def _descriptor(opened: ExitStack) -> int:
    """The descriptor of standard input; of the null device if it is closed or replaced by an object."""
    try:
        return sys.stdin.fileno()
    except (AttributeError, OSError, ValueError):
        return opened.enter_context(Path(os.devnull).open()).fileno()
