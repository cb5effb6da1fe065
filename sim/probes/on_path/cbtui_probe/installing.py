"""Installs the probe's hooks in rclpy."""

from __future__ import annotations

import os
import sys
import threading
from pathlib import Path
from traceback import walk_tb
from typing import Any

from . import CHANGES
from .callbacks import is_own, told_of
from .clients import watch_clients, watch_services
from .entities import Entities
from .executors import Executors
from .own_lines import culprit_of
from .positions import PositionSampler
from .recorder import Recorder, now
from .sockets import Server
from .tuning import Tuning
from .turns import Turns
from .unseen import leave_out_probe
from .waits import Waits

_SEVERITIES = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}


def install(folder: str) -> None:
    """Record what this process does with rclpy, and serve that at a socket in ``folder``.

    Raises:
        Exception: this version of rclpy lacks something that the probe hooks.
    """
    import rclpy.client
    import rclpy.executors
    import rclpy.node
    import rclpy.publisher
    import rclpy.service
    import rclpy.task
    import rclpy.timer
    from rclpy.impl.implementation_singleton import rclpy_implementation

    recorder = Recorder()
    tuning, turns = Tuning(recorder), Turns()
    executors, entities = Executors(recorder, tuning, turns), Entities(recorder, tuning)
    waits = Waits(recorder, entities, executors, rclpy_implementation)
    positions = PositionSampler(recorder, executors)

    def look() -> None:
        positions.look()
        waits.look()

    server = Server(recorder, look, turns)
    server.start(folder)
    executors.watch(rclpy, rclpy_implementation)
    entities.watch(rclpy.node.Node)
    entities.watch_rhythms(rclpy.timer.Timer)
    entities.watch_tasks(rclpy.executors.Executor)
    if hasattr(rclpy_implementation, "EventsExecutor"):
        entities.watch_tasks(rclpy_implementation.EventsExecutor)
    entities.watch_publishing(rclpy.publisher.Publisher)
    watch_clients(recorder, rclpy.client.Client)
    watch_services(recorder, rclpy.service.Service, rclpy_implementation)
    _watch_log(recorder, rclpy_implementation)
    _watch_tasks(rclpy.task.Task)
    _watch_end(recorder, executors)
    _watch_threads(recorder, rclpy.executors.ExternalShutdownException)


def _watch_log(recorder: Recorder, rclpy_implementation: Any) -> None:
    write = rclpy_implementation.rclpy_logging_rcutils_log

    def write_known(severity: Any, name: str, message: str, *place: Any) -> None:
        thread, entity = recorder.thread(), recorder.here.entity
        recorder.put("log", now(), _SEVERITIES.get(int(severity), "INFO"), name, message, thread, entity)
        write(severity, name, message, *place)

    rclpy_implementation.rclpy_logging_rcutils_log = write_known


def _watch_tasks(task_class: Any) -> None:
    """Let a task that raised keep its function: no frame shows one that was not even entered."""
    complete = task_class._complete_task

    def complete_and_keep(task: Any) -> None:
        ran = task._handler, task._args
        complete(task)
        if task._exception is not None:
            task._handler, task._args = ran

    task_class._complete_task = complete_and_keep


def _others_go_on(recorder: Recorder, executors: Executors) -> bool:
    """Whether Python waits at its end for another thread: idle workers of pools end by themselves."""
    pools = sys.modules.get("concurrent.futures.thread")
    busy = {recorder.idents[each] for spinner in executors.all() for each in spinner.busy.copy()}
    idle = {each for each in getattr(pools, "_threads_queues", ()) if each.ident not in busy}
    others = (each for each in threading.enumerate() if each is not threading.main_thread())
    return any(not each.daemon and each not in idle for each in others)


def _watch_end(recorder: Recorder, executors: Executors) -> None:
    report = sys.excepthook

    def report_known(kind: Any, error: Any, _trace: Any) -> None:
        leave_out_probe(error)
        if issubclass(kind, KeyboardInterrupt):
            if CHANGES in os.environ:  # that is how a run of the console's own ends
                return
        else:
            text, *place = told_of(error)
            if isinstance(error, SyntaxError) and Path(error.filename or "").is_file():
                text, place = f"{type(error).__name__}: {error.msg}", [error.filename, error.lineno or 0]
            *place, advice = culprit_of(error, is_own) or (*place, "")
            goes_on = _others_go_on(recorder, executors)
            recorder.put("uncaught", now(), text, *place, type(error).__name__, advice, goes_on)
        report(kind, error, error.__traceback__)

    sys.excepthook = report_known


def _watch_threads(recorder: Recorder, shut_down: type[Exception]) -> None:
    """Record the exceptions that end threads, unless that is how the end of the run ends one that spins."""
    report = threading.excepthook

    def report_known(failed: threading.ExceptHookArgs) -> None:
        error = failed.exc_value
        if isinstance(error, Exception) and not isinstance(error, shut_down):
            leave_out_probe(error)
            text, file, line = told_of(error)
            if not any(is_own(frame) for frame, _ in walk_tb(error.__traceback__)):
                file, line = "", 0
            where = f"{Path(file).name}:{line}: " if file else ""
            name = "a thread" if failed.thread is None else failed.thread.name
            told = f"{where}{text}; {name} ended by it, and the rest goes on"
            recorder.put(
                *("notice", now(), "ERROR", told, 0, False, "thread died", "", ""), (file, line), text
            )
        report(failed)

    threading.excepthook = report_known
