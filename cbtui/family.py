"""The processes of one engine: what they take of the machine, and how they are ended.

A process that a program starts, and what that one starts, are the engine's children's children, or in its
session; those that leave both still have the mark that the engine got in its environment. All that is looked
for in ``/proc``; where there is none, only the engine's own group is known.
"""

import os
import signal
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

MARK = "CBTUI_RUN"
"""The environment variable that holds the mark."""

_PROC = Path("/proc")
_SWEEPS = 20
"""How often processes are looked for that were started while others were being ended."""
_PAGE = os.sysconf("SC_PAGESIZE")


class Family:
    """The engine ``pid`` and every process that came of it. Thread-safe."""

    def __init__(self, pid: int, mark: str) -> None:
        self.pid = pid
        self._entry = f"{MARK}={mark}\0".encode()

    def lives(self) -> bool:
        """Whether the engine itself has not ended."""
        try:
            state, *_ = _status(_PROC / str(self.pid))
        except OSError:
            return not _PROC.exists()
        return state not in {"Z", "X"}

    def is_stopped(self) -> bool:
        """Whether the engine has been stopped, as by SIGSTOP, and not ended."""
        try:
            state, *_ = _status(_PROC / str(self.pid))
        except OSError:
            return False
        return state in {"T", "t"}

    def memory(self, processes: Iterable[int]) -> int:
        """Bytes of memory that processes hold; what several of them share may count for each."""
        return sum(map(_resident, processes))

    def own_memory(self, processes: Iterable[int]) -> int:
        """Bytes of memory that processes hold, what they share counted once. Dearer than ``memory``."""
        return sum(map(_proportional, processes))

    def descendants(self) -> list[int]:
        """The engine and those that are its children, their children and so on."""
        found = [self.pid]
        for pid in found:
            with suppress(OSError):
                for children in (_PROC / str(pid) / "task").glob("*/children"):
                    with suppress(OSError):
                        found += map(int, children.read_text().split())
        return found

    def end(self) -> None:
        """Kill them all but the caller; those that start others are stopped first, so that none gets away."""
        stopped: set[int] = set()
        for _ in range(_SWEEPS):
            found = {*self._marked(), *self.descendants()} - stopped - {os.getpid()}
            if not found:
                break
            for pid in found:
                _send(pid, signal.SIGSTOP)
            stopped |= found
        for pid in stopped:
            _send(pid, signal.SIGKILL)
        if not _PROC.exists():
            with suppress(OSError):
                os.killpg(self.pid, signal.SIGKILL)

    def wait_for_end(self, seconds: float) -> bool:
        """Wait until the engine has ended, at most so long; whether it has."""
        deadline = time.monotonic() + seconds
        while self.lives():
            if time.monotonic() > deadline:
                return False
            time.sleep(0.005)
        return True

    def _marked(self) -> Iterator[int]:
        if not _PROC.exists():
            return
        for place in _PROC.iterdir():
            if place.name.isdigit():
                with suppress(OSError):
                    if self._is_ours(place):
                        yield int(place.name)

    def _is_ours(self, place: Path) -> bool:
        _, _, _, session, *_ = _status(place)
        return int(session) == self.pid or self._entry in (place / "environ").read_bytes()


def _status(place: Path) -> list[str]:
    """State, parent, group, session and so on of a process."""
    return (place / "stat").read_text(errors="replace").rpartition(")")[2].split()


def _resident(pid: int) -> int:
    try:
        return int((_PROC / str(pid) / "statm").read_text().split()[1]) * _PAGE
    except OSError:
        return 0


def _proportional(pid: int) -> int:
    try:
        rollup = (_PROC / str(pid) / "smaps_rollup").read_text()
    except OSError:
        return _resident(pid)
    return next((int(line.split()[1]) * 1024 for line in rollup.splitlines() if line.startswith("Pss:")), 0)


def _send(pid: int, number: int) -> None:
    with suppress(OSError):
        os.kill(pid, number)
