"""The ``ros2`` command, carried out inside a run against the nodes that are there."""

from sim.packages import Packages
from sim.shell.completion import complete, word_start
from sim.shell.line import Line
from sim.shell.session import Failed
from sim.shell.splitting import LineError, split
from sim.shell.tools import OnExit, Running, Tools

__all__ = [
    "Failed",
    "Line",
    "LineError",
    "OnExit",
    "Packages",
    "Running",
    "Tools",
    "complete",
    "split",
    "word_start",
]
