"""The ``ros2`` command, carried out inside a run on its nodes."""

from sim.shell.completion import complete, word_start
from sim.shell.line import ShellLine
from sim.shell.starter import OnExit, Running

__all__ = [
    "ShellLine",
    "OnExit",
    "Running",
    "complete",
    "word_start",
]
