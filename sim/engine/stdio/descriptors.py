"""Keeps a program from the console's terminal: what it writes past Python's own streams becomes lines too.

A shell that it starts, a library in C and ``os.write(1, …)`` all write to the process's first descriptors,
which an engine would share with the console.
"""

import os
import signal
import sys
import threading
from collections.abc import Callable

# Kept from before a clock puts its own in its place.
_Thread = threading.Thread

_LONGEST = 4096
"""Bytes of a line; a longer one is cut into several."""
_LAST_LINES = 0.1
"""Real seconds for what was written last to be read at the end of a run."""

TakeLine = Callable[[str, bool], None]
"""Gets a line, and whether it was written to standard error."""


class Descriptors:
    """The descriptors 0 to 2 of an engine. ``take`` is called on threads of their own."""

    def __init__(self, take: TakeLine) -> None:
        self._take = take
        self._readers: list[threading.Thread] = []

    def detach(self) -> None:
        """Read what is written to the descriptors 1 and 2."""
        for number in (1, 2):
            reading, writing = os.pipe()
            os.dup2(writing, number)
            os.close(writing)
            reader = _Thread(target=self._read, args=(reading, number == 2), name="output", daemon=True)
            self._readers.append(reader)
            reader.start()

    def finish(self) -> None:
        """Take what was written last; what goes on to write is not waited for."""
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for number in (1, 2):
            os.dup2(nowhere, number)
        for reader in self._readers:
            reader.join(_LAST_LINES)

    def _read(self, pipe: int, error: bool) -> None:
        with os.fdopen(pipe, "rb") as stream:
            while line := stream.readline(_LONGEST):
                self._take(line.decode(errors="replace").removesuffix("\n").removesuffix("\r"), error)


def leave_terminal() -> None:
    """Start a session without a terminal: programs have no ``/dev/tty``, and Ctrl-C goes to the console.

    The console starts engines with SIGINT blocked; a SIGINT that is pending by now is dropped.
    """
    os.setsid()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # forgets what waits
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    signal.signal(signal.SIGINT, signal.default_int_handler)


def print_to_descriptors() -> None:
    """Have Python's streams write to the descriptors again, as those of any process do."""
    sys.stdout, sys.stderr = (open(number, "w", buffering=1, closefd=False) for number in (1, 2))  # noqa: SIM115 -- streams that stay open
