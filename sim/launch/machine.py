"""The interface between launches and the engine, which runs programs and keeps time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

OnExit = Callable[[int], None]
"""Takes the exit status of a process, once."""
OnOutput = Callable[[str, bool], None]
"""Takes a line that a process prints or logs, and whether to stderr. Called on any thread; must not wait."""


@dataclass(frozen=True, slots=True)
class ProcessSpec:
    """A program to start as a process of its own.

    ``path`` is run as a script, or ``function`` of the module ``module`` in it is called; ``folder`` is where
    imports look first. ``arguments`` follow the program's own name. ``label`` names the process in
    the log, such as ``exercise51-1``. ``package`` and ``executable`` are empty for a plain file.
    """

    label: str
    path: Path
    folder: Path
    arguments: tuple[str, ...] = ()
    module: str = ""
    function: str = ""
    package: str = ""
    executable: str = ""
    environment: Mapping[str, str] = field(default_factory=dict)
    """The variables that differ from this process's own."""
    output: str = "log"
    """``screen`` and ``both`` show all output; ``log`` shows, as launch does, only stderr."""
    working_folder: Path | None = None
    """None: the folder in which the launch was started."""

    @property
    def command(self) -> str:
        """The command line, as launch reports it for a process that died."""
        return " ".join((str(self.path), *self.arguments))


class RunningProcess(Protocol):
    """A started process. Its methods do not wait, and do nothing once it has ended."""

    @property
    def number(self) -> int:
        """The number that represents its process id."""

    def interrupt(self) -> None:
        """End the process as Ctrl-C would."""

    def terminate(self) -> None:
        """End the process as SIGTERM would."""

    def kill(self) -> None:
        """End the process as SIGKILL would."""


class Machine(Protocol):
    """Runs processes, keeps time and shows the log.

    ``on_exit`` and timed actions are called on the thread, or under the lock, with which the launch was
    started, never two at once; ``on_exit`` may be called inside ``start_process``.
    """

    def start_process(self, spec: ProcessSpec, on_exit: OnExit, on_output: OnOutput) -> RunningProcess:
        """Start a program."""

    def run_line(
        self, label: str, words: Sequence[str], on_exit: OnExit, on_output: OnOutput
    ) -> RunningProcess:
        """Start a ``ros2 …`` line; ``label`` names it in the log."""

    def call_at(self, seconds_from_now: float, action: Callable[[], None]) -> None:
        """Call ``action`` that many seconds from now."""

    def say(self, text: str, severity: str = "INFO", logger: str = "launch") -> None:
        """Show a line of the launch's own log, printed as ``[INFO] [launch]: text``."""
