"""The processes of one engine: what they take of the machine, and how they are ended.

The engine is a subreaper: whatever a program starts stays below it in the process tree as long as it lives,
daemons included, and is ended as it leaves. If it is killed, they are known by its session, by the mark that
it got in its environment, and by the last look at the tree; what started since then, in a session and an
environment of its own, is not found any more. All that is looked for in ``/proc``; where there is none, only
the engine's own group is known.
"""

import ctypes
import os
import signal
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn, cast

MARK = "CBTUI_RUN"
"""The environment variable that holds the mark."""

_PROC = Path("/proc")
_SWEEPS = 20
"""How often processes are looked for that were started while others were being ended."""
_PR_SET_CHILD_SUBREAPER = 36
"""Of Linux's ``prctl``: orphans below the caller become its children."""
_PAGE = os.sysconf("SC_PAGESIZE")


class Family:
    """The engine ``pid`` and every process that came of it. Thread-safe."""

    def __init__(self, pid: int, mark: str) -> None:
        self.pid = pid
        self._entry = f"{MARK}={mark}\0".encode()
        self._seen: dict[int, str] = {}

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
        """The engine and those that are its children, their children and so on, but for zombies."""
        found = [self.pid]
        for pid in found:
            with suppress(OSError):
                for children in (_PROC / str(pid) / "task").glob("*/children"):
                    with suppress(OSError):
                        found += map(int, children.read_text().split())
        seen = {pid: began for pid in found if (began := _began(pid))}
        if self.pid in seen:  # else nobody is below it any more
            self._seen = seen
        return [self.pid, *(pid for pid in found[1:] if pid in seen)]

    def leave_nothing(self) -> None:
        """Have the calling process be the engine: it keeps orphans, and ends all below it as it leaves."""
        if sys.platform != "linux":
            return
        ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
        leave, system = os._exit, cast("Any", os)

        def leave_nothing(status: int) -> NoReturn:
            if os.getpid() == self.pid and len(self.descendants()) > 1:
                self.end()
            leave(status)

        system._exit = leave_nothing

    def end(self) -> None:
        """Kill them all but the caller; those that start others are stopped first, so that none gets away."""
        stopped: set[int] = set()
        seen = {pid for pid, began in self._seen.items() if _began(pid) == began}
        for _ in range(_SWEEPS):
            found = {*seen, *self._marked(), *self.descendants()} - stopped - {os.getpid()}
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


def _began(pid: int) -> str:
    """When a process began, which tells it from a later one of that number; "" if it is no more."""
    try:
        state, *rest = _status(_PROC / str(pid))
    except OSError:
        return ""
    return "" if state in {"Z", "X"} else rest[18]


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
