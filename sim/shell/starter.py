"""What a line needs of the run around it: packages, and programs to start."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

from sim.packages import Packages

OnExit: TypeAlias = Callable[[int], None]
"""Called once with the exit status, by a thread that lives on the ground's time."""


class Running(Protocol):
    """Programs that a line started."""

    def interrupt(self) -> None:
        """End them as Ctrl-C would. Does not wait; any thread may call it, more than once."""


class LineStarter(Protocol):
    """Starts programs for a line; called on the line's own thread. Its errors are sentences."""

    def packages(self) -> Packages:
        """Return the packages of the workspace."""

    def start_executable(
        self, package: str, executable: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Running:
        """Start a program of a package, as a process of its own."""

    def launch(
        self, package: str | None, launch_file: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Running:
        """Start a launch file, of a package or (None) by its path, with ``name:=value`` arguments."""

    def describe_launch(self, package: str | None, launch_file: str) -> str:
        """Return what ``ros2 launch --show-args`` prints about a launch file."""
