"""Processes that a learner's program starts by itself, with ``multiprocessing``: they compute and print."""

import multiprocessing
import multiprocessing.process
import os
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any, NoReturn

from sim.engine.outbox import Outbox
from sim.ros.host import Host
from sim.trace.events import AnyEvent

# Kept from before a clock puts its own in its place.
_sleep = time.sleep

_POLL = 0.5
"""Seconds after which a child notices that its engine is gone."""


def allow_children(host: Host, outbox: Outbox, take_line: Callable[[str, bool], None]) -> None:
    """Let programs start processes; ``take_line`` gets what these print, and whether it is for stderr.

    They are forked, as by default on Linux, and end with the engine. ROS stays with the program: a child
    that uses it gets NotImplementedError.
    """
    multiprocessing.set_start_method("fork", force=True)  # the engine itself was spawned
    current: Any = multiprocessing.process.current_process()
    current._config["daemon"] = False  # a daemon must not have children, and the engine is one
    pipes = {error: os.pipe() for error in (False, True)}
    for error, (reading, _) in pipes.items():
        threading.Thread(target=_read, args=(reading, error, take_line), name="children", daemon=True).start()
    engine = os.getpid()

    def be_child() -> None:
        lock: Any = host.lock
        lock._at_fork_reinit()  # whoever held it is a thread of the engine
        outbox._waiting = _NoRos()
        sys.stdout, sys.stderr = (os.fdopen(pipes[error][1], "w", buffering=1) for error in (False, True))
        threading.Thread(target=_end_with, args=(engine,), daemon=True).start()

    os.register_at_fork(after_in_child=be_child)


def refuse_children() -> None:
    """Have every start of a process say that there are none on virtual time."""

    def start(_process: object) -> NoReturn:
        raise NotImplementedError("multiprocessing does not live on virtual time; use --clock real")

    process_class: Any = multiprocessing.process.BaseProcess
    process_class.start = start


class _NoRos(deque[AnyEvent]):
    """Stands in a child for the events that wait to be sent: nobody would send them."""

    def append(self, _event: AnyEvent) -> NoReturn:
        """Refuse.

        Raises:
            NotImplementedError: always.
        """
        raise NotImplementedError(
            "a process that a program starts with multiprocessing cannot use ROS here, only compute and "
            "print; hand its results to the program, and publish and log there"
        )


def _read(pipe: int, error: bool, take_line: Callable[[str, bool], None]) -> None:
    with os.fdopen(pipe, errors="replace") as lines:
        for line in lines:
            take_line(line.removesuffix("\n"), error)


def _end_with(engine: int) -> None:
    while os.getppid() == engine:
        _sleep(_POLL)
    os._exit(1)
