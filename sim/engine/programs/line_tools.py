"""What a ``ros2`` line is given in an engine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sim.engine.programs.starting import ProgramStarter, StartError

if TYPE_CHECKING:
    from sim.packages import Packages
    from sim.shell import OnExit, Running


@dataclass(frozen=True)
class LineTools:
    """Takes a line's output and its end, and starts programs for it.

    ``take`` gets text and whether it belongs on standard error, ``end`` the exit status.
    """

    starter: ProgramStarter
    take: Callable[[str, bool], None]
    end: Callable[[int], None]

    def say(self, text: str, error: bool) -> None:
        """Take a line of output."""
        self.take(text, error)

    def ended(self, status: int) -> None:
        """Take the exit status."""
        self.end(status)

    def packages(self) -> Packages:
        """The packages at hand."""
        return self.starter.packages()

    def start_executable(
        self, package: str, executable: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Running:
        """Start a program of a package."""
        with _as_command_failures():
            return self.starter.start_executable(package, executable, arguments, on_exit)

    def launch(
        self, package: str | None, launch_file: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Running:
        """Start a launch file."""
        with _as_command_failures():
            return self.starter.launch(package, launch_file, arguments, on_exit)

    def describe_launch(self, package: str | None, launch_file: str) -> str:
        """What ``ros2 launch --show-args`` prints of a launch file."""
        with _as_command_failures():
            return self.starter.describe_launch(package, launch_file)


@contextmanager
def _as_command_failures() -> Iterator[None]:
    from sim.shell import CommandFailed

    try:
        yield
    except StartError as error:
        raise CommandFailed(str(error)) from error
