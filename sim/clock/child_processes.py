"""Child processes of a learner's program: while one runs, virtual time passes as real time."""

import os
import subprocess
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from sim.clock.outside_work import OutsideWork
from sim.clock.replacing import Replacements

_waitid = os.waitid


class ChildProcesses:
    """The running child processes of a run."""

    def __init__(self, outside: OutsideWork) -> None:
        self._outside = outside
        self._running: set[int] = set()
        outside.also(self._any_runs)

    def replace(self, replacements: Replacements) -> None:
        """Track started processes, and wait for them without blocking the other threads."""
        popen: Any = subprocess.Popen
        start = popen._execute_child
        owns = replacements.clock.owns_current_thread

        def execute(process: Any, *arguments: Any) -> None:
            if not owns():
                start(process, *arguments)
                return
            self._outside.begin()
            start(process, *arguments)
            self._started(process.pid, "subprocess")

        def poll(process: Any) -> int | None:
            code: int | None = look(process)
            if code is None and owns():
                self._outside.glance()
            return code

        look = popen.poll
        popen._execute_child, popen.poll = execute, poll
        for name in ("posix_spawn", "posix_spawnp"):
            replacements.put(os, name, self._spawning(getattr(os, name), name))
        system = os.system
        replacements.put(os, "system", lambda command: self._outside.call(system, command, what="os.system"))
        for name in ("waitpid", "waitid", "wait3", "wait4"):
            replacements.put(os, name, self._waiting(getattr(os, name), f"os.{name}"))
        replacements.put(os, "wait", lambda: os.waitpid(-1, 0))

    def _spawning(self, spawn: Callable[..., int], name: str) -> Callable[..., int]:
        def spawned(*arguments: Any, **named: Any) -> int:
            self._outside.begin()
            pid = spawn(*arguments, **named)
            self._started(pid, f"os.{name}")
            return pid

        return spawned

    def _started(self, pid: int, what: str) -> None:
        self._running.add(pid)
        self._outside.tell(f"{what} starts a process, which takes as long as it takes")

    def _waiting(self, wait: Callable[..., Any], what: str) -> Callable[..., Any]:
        def waited(*arguments: int) -> Any:
            *whose, options = arguments
            ended: Any = None

            def look() -> bool:
                nonlocal ended
                ended = wait(*whose, options | os.WNOHANG)
                return ended is not None and ended[0] != 0

            self._outside.wait(look, 0 if options & os.WNOHANG else None, what)
            return ended

        return waited

    def _any_runs(self) -> bool:
        self._running = {pid for pid in self._running if _runs(pid)}
        return bool(self._running)


def _runs(pid: int) -> bool:
    with suppress(ChildProcessError):  # somebody has waited for it
        return _waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None
    return False
