"""Separates programs from the console's terminal: output past Python's own streams becomes lines, too.

Shells, C libraries and ``os.write(1, …)`` write to the process's first descriptors, which an engine would
share with the console.
"""

import os
import signal
import sys
import threading
from collections.abc import Callable

# Kept from before a clock replaces it.
_Thread = threading.Thread

_LONGEST = 4096
"""Limit for the bytes of a line; a longer one is split."""
_LAST_LINES = 0.1
"""Real seconds for reading the last output at the end of a run."""

TakeLine = Callable[[str, bool], None]
"""Takes a line, and whether it was written to standard error."""


class Descriptors:
    """The descriptors 0 to 2 of an engine. ``take`` is called on threads of their own."""

    def __init__(self, take: TakeLine) -> None:
        self._take = take
        self._readers: list[threading.Thread] = []

    def detach(self) -> None:
        """Start to read the output of descriptors 1 and 2."""
        for number in (1, 2):
            reading, writing = os.pipe()
            os.dup2(writing, number)
            os.close(writing)
            reader = _Thread(target=self._read, args=(reading, number == 2), name="output", daemon=True)
            self._readers.append(reader)
            reader.start()

    def finish(self) -> None:
        """Read the last output; output that continues is dropped."""
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
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # drops pending ones
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    signal.signal(signal.SIGINT, signal.default_int_handler)


def print_to_descriptors() -> None:
    """Let Python's streams write to the descriptors again."""
    sys.stdout, sys.stderr = (open(number, "w", buffering=1, closefd=False) for number in (1, 2))  # noqa: SIM115 -- streams that stay open
