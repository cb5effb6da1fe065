"""``launch.events.process``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sim.launch.errors import unsupported
from sim.launch.launch.event import Event

__all__ = [
    "ProcessExited",
    "ProcessIO",
    "ProcessStarted",
    "ProcessStderr",
    "ProcessStdin",
    "ProcessStdout",
    "RunningProcessEvent",
    "ShutdownProcess",
    "SignalProcess",
]


class RunningProcessEvent(Event):
    """An event of a process, with its action, label, command, folder, environment and id."""

    def __init__(
        self,
        *,
        action: Any,
        name: str,
        cmd: Sequence[str],
        cwd: str | None,
        env: Mapping[str, str] | None,
        pid: int,
    ) -> None:
        self.action = action
        self.process_name = name
        self.cmd = list(cmd)
        self.cwd = cwd
        self.env = env
        self.pid = pid


class ProcessStarted(RunningProcessEvent):
    """A process has started."""

    name = "launch.events.process.ProcessStarted"


class ProcessExited(RunningProcessEvent):
    """A process has ended with ``returncode``."""

    name = "launch.events.process.ProcessExited"

    def __init__(self, *, returncode: int, **about: Any) -> None:
        super().__init__(**about)
        self.returncode = returncode


class ProcessIO(RunningProcessEvent):
    """A process wrote ``text``, bytes, to standard output (``fd`` 1) or error (2): one line an event."""

    name = "launch.events.process.ProcessIO"

    def __init__(self, *, text: bytes, fd: int, **about: Any) -> None:
        super().__init__(**about)
        self.text = text
        self.from_stdin, self.from_stdout, self.from_stderr = (fd == each for each in range(3))


class ProcessStdin(ProcessIO):
    """Text for a process's standard input; neither launch nor this model sends any."""

    name = "launch.events.process.ProcessStdin"

    def __init__(self, *, text: bytes, **about: Any) -> None:
        super().__init__(text=text, fd=0, **about)


class ProcessStdout(ProcessIO):
    """A process printed a line."""

    name = "launch.events.process.ProcessStdout"

    def __init__(self, *, text: bytes, **about: Any) -> None:
        super().__init__(text=text, fd=1, **about)


class ProcessStderr(ProcessIO):
    """A process wrote a line to standard error, where loggers write."""

    name = "launch.events.process.ProcessStderr"

    def __init__(self, *, text: bytes, **about: Any) -> None:
        super().__init__(text=text, fd=2, **about)


class ShutdownProcess(Event):
    """A request to end processes; ``process_matcher`` selects their actions."""

    name = "launch.events.process.ShutdownProcess"

    def __init__(self, *, process_matcher: Any) -> None:
        self.process_matcher = process_matcher


SignalProcess = unsupported("SignalProcess", "; ShutdownProcess ends a process")
