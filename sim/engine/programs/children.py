"""Processes that a learner's program starts by itself, with ``multiprocessing``: they compute and print."""

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

# Kept from before a clock puts its own in its place.
_sleep = time.sleep

_POLL = 0.5
"""Seconds after which a child notices that its engine is gone."""


def allow_children(host: Host, outbox: Outbox, pipe: Connection) -> None:
    """Let programs start processes; what these print goes to the engine's descriptors.

    They are forked, as by default on Linux, and end with the engine, whose ``pipe`` they have no part in.
    ROS stays with the program: a child that uses it gets NotImplementedError.
    """
    multiprocessing.set_start_method("fork", force=True)  # the engine itself was spawned
    current: Any = multiprocessing.process.current_process()
    current._config["daemon"] = False  # a daemon must not have children, and the engine is one
    engine = os.getpid()

    def be_child() -> None:
        lock: Any = host.lock
        lock._at_fork_reinit()  # whoever held it is a thread of the engine
        outbox._waiting = _NoRos()
        with suppress(OSError):  # a program may have closed it
            pipe.close()
        print_to_descriptors()
        threading.Thread(target=_end_with, args=(engine,), daemon=True).start()

    os.register_at_fork(after_in_child=be_child)


def refuse_children() -> None:
    """Have every start of a process say that there are none on virtual time."""

    def start(_process: object) -> NoReturn:
        raise NotImplementedError("multiprocessing does not live on virtual time; use --clock real")

    def fork() -> NoReturn:
        raise NotImplementedError("os.fork does not live on virtual time; use --clock real")

    process_class: Any = multiprocessing.process.BaseProcess
    process_class.start = start
    system: Any = os
    system.fork = system.forkpty = fork


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


def _end_with(engine: int) -> None:
    while os.getppid() == engine:
        _sleep(_POLL)
    os._exit(1)
