"""What a line needs from whoever carries it out: a place for its output, packages, and programs to start."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

from sim.packages import Packages

OnExit: TypeAlias = Callable[[int], None]
"""Called once with the exit status, by a thread that lives on the ground's time."""


class Running(Protocol):
    """Programs that a line started."""

    def interrupt(self) -> None:
        """End them as Ctrl-C would. Any thread may call it, as often as wanted; it does not wait."""


class Tools(Protocol):
    """What is called for a line, on the line's own thread."""

    def say(self, text: str, error: bool) -> None:
        """Take a line of output; ``error``: it belongs on stderr."""

    def ended(self, status: int) -> None:
        """Take the exit status, once, after all else; a line that the end of the run cuts off has none."""

    def packages(self) -> Packages:
        """The packages at hand."""

    def start_executable(
        self, package: str, executable: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Running:
        """Start a program that the packages know, as a node's process of its own."""

    def launch(
        self, package: str | None, launch_file: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Running:
        """Start a launch file, of a package or (None) by its path, with ``name:=value`` arguments."""

    def describe_launch(self, package: str | None, launch_file: str) -> str:
        """What ``ros2 launch --show-args`` prints of a launch file."""
