"""The ``ros2`` command, carried out inside a run against the nodes that are there."""

from sim.packages import Packages
from sim.shell.completion import complete, word_start
from sim.shell.line import ShellLine
from sim.shell.session import CommandFailed
from sim.shell.splitting import LineError, split
from sim.shell.tools import OnExit, Running, Tools

__all__ = [
    "CommandFailed",
    "ShellLine",
    "LineError",
    "OnExit",
    "Packages",
    "Running",
    "Tools",
    "complete",
    "split",
    "word_start",
]
