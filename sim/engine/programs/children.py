"""Processes that a learner's program starts with ``multiprocessing``: they may compute and print."""

import multiprocessing
import multiprocessing.process
import os
import threading
import time
from collections import deque
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any, NoReturn

from sim.engine.outbox import Outbox
from sim.engine.stdio.descriptors import print_to_descriptors
from sim.ros.middleware.host import Host
from sim.trace.events import AnyEvent

# Kept from before a clock replaces it.
_sleep = time.sleep

_POLL = 0.5
"""Seconds between two checks of a child whether its engine is alive."""


def allow_children(host: Host, outbox: Outbox, pipe: Connection) -> None:
    """Let programs start processes; their output goes to the engine's descriptors.

    They are forked, as by default on Linux, do not keep the engine's ``pipe``, and end with the engine. A
    child that uses ROS gets NotImplementedError.
    """
    multiprocessing.set_start_method("fork", force=True)  # the engine itself was spawned
    current: Any = multiprocessing.process.current_process()
    current._config["daemon"] = False  # a daemon, as the engine is, must not have children
    engine = os.getpid()

    def be_child() -> None:
        lock: Any = host.lock
        lock._at_fork_reinit()  # its holder may be a thread of the engine
        outbox._waiting = _NoRos()
        with suppress(OSError):  # a program may have closed it
            pipe.close()
        print_to_descriptors()
        threading.Thread(target=_end_with, args=(engine,), daemon=True).start()

    os.register_at_fork(after_in_child=be_child)


def refuse_children() -> None:
    """Make every start of a process raise NotImplementedError, as virtual time has none."""

    def start(_process: object) -> NoReturn:
        raise NotImplementedError("multiprocessing does not work on virtual time; use --clock real")

    def fork() -> NoReturn:
        raise NotImplementedError("os.fork does not work on virtual time; use --clock real")

    process_class: Any = multiprocessing.process.BaseProcess
    process_class.start = start
    system: Any = os
    system.fork = system.forkpty = fork


class _NoRos(deque[AnyEvent]):
    """Replaces the queue of events in a child, which has no thread to send them; ``append`` raises."""

    def append(self, _event: AnyEvent) -> NoReturn:
        raise NotImplementedError(
            "a process that a program starts with multiprocessing cannot use ROS here, only compute and "
            "print; hand its results to the program, and publish and log there"
        )


def _end_with(engine: int) -> None:
    while os.getppid() == engine:
        _sleep(_POLL)
    os._exit(1)
