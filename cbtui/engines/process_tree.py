"""The process tree of one engine: its memory, and how it is ended.

The engine is a subreaper: processes that its program starts, daemons included, stay below it while it lives,
and are ended as it exits. If the engine is killed, its processes are found by its session, by the mark in
their environment, and by the last snapshot of the tree. A process that was started after that snapshot, in a
session and an environment of its own, is not found.
"""

import ctypes
import os
import sys
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn, cast

import psutil
from psutil import Process

MARK = "CBTUI_RUN"
"""The environment variable that marks an engine's processes."""

_SWEEPS = 20
"""How often to look for processes that were started while others were being ended."""
_PR_SET_CHILD_SUBREAPER = 36
"""Of Linux's ``prctl``: orphans below the caller become its children."""
_PR_SET_NAME = 15
"""Of Linux's ``prctl``: the caller's name in lists of processes, of 15 bytes at most."""
_GUARD = "cbtui-guard"
_CHILDREN_LISTED = Path(f"/proc/self/task/{threading.get_native_id()}/children").exists()
"""Whether the kernel lists the children of each thread."""
_ENDED = {psutil.STATUS_ZOMBIE, psutil.STATUS_DEAD}
_STOPPED = {psutil.STATUS_STOPPED, psutil.STATUS_TRACING_STOP}


class ProcessTree:
    """The engine ``pid`` and all processes below it. Thread-safe."""

    def __init__(self, pid: int, mark: str) -> None:
        self.pid = pid
        self._mark = mark
        self._seen: list[Process] = []

    def lives(self) -> bool:
        """Whether the engine itself has not ended."""
        return _status(self.pid) not in _ENDED

    def is_stopped(self) -> bool:
        """Whether the engine has been stopped, as by SIGSTOP, and not ended."""
        return _status(self.pid) in _STOPPED

    def engine(self) -> list[Process]:
        """The engine's process alone, which is cheap to look up; empty if it is gone."""
        return list(_processes([self.pid]))

    def processes(self) -> list[Process]:
        """The engine and all processes below it, without zombies."""
        found = [each for engine in self.engine() for each in (engine, *_below(engine))]
        found = [process for process in found if _status(process.pid) not in _ENDED]
        if found and found[0].pid == self.pid:  # otherwise its children have been reparented
            self._seen = found
        return found

    def end_tree_on_exit(self) -> None:
        """Make the calling process a subreaper that ends its process tree as it exits."""
        if sys.platform != "linux":
            return
        ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
        exit_process, system = os._exit, cast("Any", os)

        def end_tree_on_exit(status: int) -> NoReturn:
            if os.getpid() == self.pid and len(self.processes()) > 1:
                self.end()
            exit_process(status)

        system._exit = end_tree_on_exit

    def end(self) -> None:
        """Kill all but the caller and the guard; each is stopped first, so that none can start another.

        The guard goes on until the console has ended, be it in the middle of this: it ends what is stopped.
        """
        stopped: set[Process] = set()
        for _ in range(_SWEEPS):
            found = {*self._seen, *self._marked(), *self.processes()} - stopped - {Process()}
            found = {process for process in found if not _is_guard(process)}
            if not found:
                break
            for process in found:
                with suppress(psutil.Error):
                    process.suspend()
            stopped |= found
        for process in stopped:
            with suppress(psutil.Error):
                process.kill()

    def wait_for_end(self, seconds: float) -> bool:
        """Wait for the engine's end, at most a number of seconds; returns whether it has ended."""
        deadline = time.monotonic() + seconds
        while self.lives():
            if time.monotonic() > deadline:
                return False
            time.sleep(0.005)
        return True

    def _marked(self) -> Iterator[Process]:
        for process in _processes(psutil.pids()):
            with suppress(psutil.Error, OSError):
                if os.getsid(process.pid) == self.pid or process.environ().get(MARK) == self._mark:
                    yield process


def become_guard() -> None:
    """Make the calling process the guard of a tree, which ends it once the console is gone."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_NAME, _GUARD.encode(), 0, 0, 0)


def _is_guard(process: Process) -> bool:
    with suppress(psutil.Error):
        return process.name() == _GUARD
    return False


def resident(process: Process) -> int:
    """Resident memory of a process in bytes; shared memory counts for each process."""
    with suppress(psutil.Error):
        return process.memory_info().rss
    return 0


def proportional(process: Process) -> int:
    """Proportional memory (PSS) of a process in bytes: shared pages count in part. Slow to read."""
    try:
        return process.memory_full_info().pss
    except (psutil.Error, AttributeError):  # Linux only
        return resident(process)


def _processes(pids: Iterable[int]) -> Iterator[Process]:
    for pid in pids:
        with suppress(psutil.Error):
            yield Process(pid)


def _below(process: Process) -> list[Process]:
    """All processes below another. ``psutil`` reads each process there is; Linux often lists children."""
    if not _CHILDREN_LISTED:
        with suppress(psutil.Error):
            return process.children(recursive=True)
        return []
    return [below for child in _processes(_children(process.pid)) for below in (child, *_below(child))]


def _children(pid: int) -> list[int]:
    found: list[int] = []
    with suppress(OSError):  # the process has ended
        for thread in Path(f"/proc/{pid}/task").iterdir():
            with suppress(OSError):  # the thread has ended
                found += map(int, (thread / "children").read_text(encoding="ascii").split())
    return found


def _status(pid: int) -> str:
    try:
        return Process(pid).status()
    except psutil.Error:
        return psutil.STATUS_DEAD
