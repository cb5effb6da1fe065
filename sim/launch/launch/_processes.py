"""Starts, restarts and ends the processes and timers of a launch, and logs and emits their events."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from sim.launch.launch.action import Action, LaunchDescriptionEntity
from sim.launch.launch.events import ExecutionComplete, Shutdown
from sim.launch.launch.events.process import (
    ProcessExited,
    ProcessIO,
    ProcessStarted,
    ProcessStderr,
    ProcessStdout,
)
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.machine import Machine, OnExit, OnOutput, ProcessSpec, RunningProcess

Visit = Callable[[LaunchDescriptionEntity], None]
Wake = Callable[[Callable[[], None]], None]
"""Runs an action, and all that it queues, after the running action; at once if none is running."""


@dataclass(frozen=True, slots=True)
class LaunchLine:
    """A ``ros2 …`` line."""

    label: str
    words: tuple[str, ...]

    @property
    def command(self) -> str:
        """The line's text."""
        return " ".join(self.words)


@dataclass(frozen=True, slots=True)
class Upkeep:
    """How a process is restarted and ended; times in seconds."""

    respawn: bool = False
    respawn_delay: float = 0.0
    most_respawns: int = -1
    """Negative: no limit."""
    sigterm_timeout: float = 5.0
    sigkill_timeout: float = 5.0


@dataclass(eq=False, slots=True)
class _Managed:
    action: Action
    what: ProcessSpec | LaunchLine
    upkeep: Upkeep
    running: RunningProcess | None = None
    respawns: int = 0


class Processes:
    """The processes and timers of one launch. Used under the launch's lock or on its thread."""

    def __init__(self, context: LaunchContext, visit: Visit, wake: Wake) -> None:
        self._context = context
        self._visit = visit
        self._wake = wake
        self._labels = 0
        self._managed: list[_Managed] = []
        self._timers = 0
        self._unheard: deque[Callable[[], None]] = deque()

    @property
    def any_left(self) -> bool:
        """Whether a process runs or a process or timer is due."""
        return bool(self._managed) or (self._timers > 0 and not self._context.is_shutdown)

    def label(self, stem: str) -> str:
        """Return the next process's label: its program's name and a number that is unique in the launch."""
        self._labels += 1
        return f"{stem}-{self._labels}"

    def start(self, action: Action, what: ProcessSpec | LaunchLine, upkeep: Upkeep) -> None:
        """Start a process after the current visit."""
        managed = _Managed(action, what, upkeep)
        self._managed.append(managed)
        self._context.later(lambda: self._start(managed))

    def _start(self, managed: _Managed) -> None:
        if self._context.is_shutdown:
            self._forget(managed)
            return
        running = _begin(
            self._context.machine, managed.what, self._on_exit(managed), self._on_output(managed)
        )
        managed.running = running
        self._context.say(f"process started with pid [{running.number}]", logger=managed.what.label)
        self._context.emit_event(ProcessStarted(**_about(managed)))

    def _on_exit(self, managed: _Managed) -> OnExit:
        return lambda status: self._wake(lambda: self._exited(managed, status))

    def _on_output(self, managed: _Managed) -> OnOutput:
        """Return a function that queues a process's lines for the launch, if a handler may match them."""

        def hear(text: str, error: bool) -> None:
            if not any(each.may_match(ProcessIO) for each in self._context.handlers):
                return
            self._unheard.append(lambda: self._heard(managed, text, error))
            self._context.machine.call_at(0, lambda: self._wake(self._hear))

        return hear

    def _hear(self) -> None:
        while self._unheard:
            self._unheard.popleft()()

    def _heard(self, managed: _Managed, text: str, error: bool) -> None:
        if managed.running is not None:  # a killed process may still print
            kind = ProcessStderr if error else ProcessStdout
            self._context.emit_event(kind(text=f"{text}\n".encode(), **_about(managed)))

    def _exited(self, managed: _Managed, status: int) -> None:
        assert managed.running is not None
        self._hear()
        what, number = managed.what, managed.running.number
        if status == 0:
            self._context.say(f"process has finished cleanly [pid {number}]", logger=what.label)
        else:
            self._context.say(
                f"process has died [pid {number}, exit code {status}, cmd '{what.command}'].",
                "ERROR",
                what.label,
            )
        self._context.emit_event(ProcessExited(returncode=status, **_about(managed)))
        managed.running = None
        self._context.later(lambda: self._follow(managed))

    def _follow(self, managed: _Managed) -> None:
        """Restart a process if its upkeep says so, after the handlers of its end."""
        upkeep = managed.upkeep
        may = upkeep.most_respawns < 0 or managed.respawns < upkeep.most_respawns
        if upkeep.respawn and may and not self._context.is_shutdown:
            managed.respawns += 1
            if upkeep.respawn_delay > 0:
                self._context.machine.call_at(
                    upkeep.respawn_delay, lambda: self._wake(lambda: self._restart(managed))
                )
            else:
                self._start(managed)
            return
        self._forget(managed)
        self._context.emit_event(ExecutionComplete(action=managed.action))

    def _forget(self, managed: _Managed) -> None:
        if managed in self._managed:  # a shutdown may have removed it
            self._managed.remove(managed)

    def _restart(self, managed: _Managed) -> None:
        if managed in self._managed:
            self._start(managed)

    def after(
        self, seconds: float, action: Action, give: Callable[[], Iterable[LaunchDescriptionEntity]]
    ) -> None:
        """Visit the entities of ``give`` in some seconds, unless the launch shuts down before."""
        self._timers += 1

        def fire() -> None:
            self._timers -= 1
            if self._context.is_shutdown:
                return
            for each in give():
                self._visit(each)
            self._context.emit_event(ExecutionComplete(action=action))

        self._context.machine.call_at(seconds, lambda: self._wake(fire))

    def end_all(self, event: Shutdown) -> None:
        """End every process; after a Ctrl-C, which reaches them directly, without a log line."""
        for managed in tuple(self._managed):
            if managed.running is None:
                self._forget(managed)
            else:
                self._end(managed, told=event.due_to_sigint)

    def end_of(self, matches: Callable[[Any], bool]) -> None:
        """End the processes of matching actions."""
        for managed in tuple(self._managed):
            if managed.running is not None and matches(managed.action):
                managed.upkeep = Upkeep(
                    sigterm_timeout=managed.upkeep.sigterm_timeout,
                    sigkill_timeout=managed.upkeep.sigkill_timeout,
                )
                self._end(managed, told=False)

    def _end(self, managed: _Managed, *, told: bool) -> None:
        running, label, upkeep = managed.running, managed.what.label, managed.upkeep
        assert running is not None
        if not told:
            self._context.say(f"sending signal 'SIGINT' to process[{label}]", logger=label)
        running.interrupt()

        def terminate() -> None:
            if managed.running is running:
                self._escalate(label, upkeep.sigterm_timeout, "SIGINT", "SIGTERM")
                running.terminate()
                machine.call_at(upkeep.sigkill_timeout, lambda: self._wake(kill))

        def kill() -> None:
            if managed.running is running:
                waited = upkeep.sigterm_timeout + upkeep.sigkill_timeout
                self._escalate(label, waited, "SIGTERM", "SIGKILL")
                running.kill()

        machine = self._context.machine
        machine.call_at(upkeep.sigterm_timeout, lambda: self._wake(terminate))

    def _escalate(self, label: str, seconds: float, before: str, now: str) -> None:
        self._context.say(
            f"process[{label}] failed to terminate '{seconds:g}' seconds after receiving '{before}', "
            f"escalating to '{now}'",
            "ERROR",
            label,
        )
        self._context.say(f"sending signal '{now}' to process[{label}]", logger=label)


def _begin(
    machine: Machine, what: ProcessSpec | LaunchLine, on_exit: OnExit, on_output: OnOutput
) -> RunningProcess:
    if isinstance(what, LaunchLine):
        return machine.run_line(what.label, what.words, on_exit, on_output)
    return machine.start_process(what, on_exit, on_output)


def _about(managed: _Managed) -> dict[str, Any]:
    """Return the arguments of the events of a process."""
    what = managed.what
    assert managed.running is not None
    about = {"action": managed.action, "name": what.label, "pid": managed.running.number}
    if isinstance(what, LaunchLine):
        return {**about, "cmd": what.words, "cwd": None, "env": None}
    folder = what.working_folder
    return {
        **about,
        "cmd": (str(what.path), *what.arguments),
        "cwd": None if folder is None else str(folder),
        "env": what.environment,
    }
