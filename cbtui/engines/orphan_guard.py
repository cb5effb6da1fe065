"""Ends an engine's process tree when the console is killed.

An engine without a console ends by itself, unless it is stopped or blocked in C code, and it cannot end the
processes that its program started. So a small process beside each engine waits for the console's end.
"""

import os
import signal
from multiprocessing.connection import Connection
from typing import NoReturn

from cbtui.engines.process_tree import ProcessTree, become_guard

_MOST_FILES = 1 << 16
"""More descriptors than a starting engine has open."""
ENDED_NORMALLY = b"."
"""What the console writes after a normal end of the engine."""


def start_orphan_guard(tree: ProcessTree, console: Connection) -> None:
    """Start the process that waits until ``console``, a pipe that only the console writes to, is closed.

    Called first of all in an engine, before it has threads. It is forked twice, so that no program can wait
    for it as its child, and closes all inherited descriptors.
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
        _wait(tree, console.fileno())


def _wait(tree: ProcessTree, console: int) -> NoReturn:
    try:
        become_guard()
        os.setsid()
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        _close_all_but(console)
        if os.read(console, 1) != ENDED_NORMALLY:
            tree.end()
    finally:
        os._exit(0)


def _close_all_but(kept: int) -> None:
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in range(3):
        os.dup2(nothing, number)
    os.closerange(3, kept)
    os.closerange(kept + 1, _MOST_FILES)
