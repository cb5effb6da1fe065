"""Ends an engine and its process tree when the console has been killed.

An engine whose console is gone ends by itself, unless it is stopped or code in C keeps it, and it cannot end
what its program started. So a small process stands beside each one, which does nothing but wait for that.
"""

import os
import signal
from multiprocessing.connection import Connection
from typing import NoReturn

from cbtui.engines.process_tree import MARK, ProcessTree

_MOST_FILES = 1 << 16
"""More than an engine has open as it begins."""
ENDS_ITSELF = b"."
"""What the console writes when it ends an engine in order."""


def watch_over(engine: int, console: Connection) -> None:
    """Start the process that waits until ``console``, a pipe that only the console writes to, is closed.

    To be called first of all in an engine, before it has threads. It belongs to nobody, so that no program
    can wait for it, and has nothing of the engine's open.
    """
    if not hasattr(os, "fork"):
        return
    between = os.fork()
    if between:
        os.waitpid(between, 0)
        console.close()
    elif os.fork():
        os._exit(0)
    else:
        _wait(engine, console.fileno())


def _wait(engine: int, console: int) -> NoReturn:
    try:
        os.setsid()
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        _let_go_of_all_but(console)
        if os.read(console, 1) != ENDS_ITSELF:
            ProcessTree(engine, os.environ.get(MARK, "")).end()
    finally:
        os._exit(0)


def _let_go_of_all_but(kept: int) -> None:
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in range(3):
        os.dup2(nothing, number)
    os.closerange(3, kept)
    os.closerange(kept + 1, _MOST_FILES)
