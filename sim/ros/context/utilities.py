"""rclpy's utilities: the default context, ROS arguments, threads and timeouts."""

import os
import sys
from collections.abc import Sequence
from typing import cast

from sim.quantities.nanoseconds import wait_ns
from sim.ros.context.context import Context
from sim.ros.middleware.process import current_process
from sim.ros.naming.remapping import is_rule


def get_default_context(*, shutting_down: bool = False) -> Context:
    """The context that functions use by default; a new one after the last one has ended."""
    process = current_process()
    context = Context() if process.default_context is None else cast("Context", process.default_context)
    process.default_context = None if shutting_down else context
    return context


def ok(*, context: Context | None = None) -> bool:
    """Whether the context is initialised and has not ended."""
    return (get_default_context() if context is None else context).ok()


def shutdown(*, context: Context | None = None) -> None:
    """End the context; RuntimeError if the context is not initialised."""
    (get_default_context(shutting_down=True) if context is None else context).shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """End the context, if it is initialised and has not ended."""
    (get_default_context(shutting_down=True) if context is None else context).try_shutdown()


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """The arguments (None: ``sys.argv``) without ROS arguments.

    ROS arguments are those between ``--ros-args`` and ``--`` (or the end), and remapping rules in the old
    form.
    """
    kept = []
    inside = False
    for argument in sys.argv if args is None else args:
        if argument == "--ros-args":
            inside = True
        elif inside:
            inside = argument != "--"
        elif not is_rule(argument):
            kept.append(argument)
    return kept


def get_rmw_implementation_identifier() -> str:
    """The name of the middleware."""
    return "cbtui"


def get_available_threads() -> int:
    """The number of CPUs that this process may use, or 2 if that is unknown."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 2


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """The nanoseconds of a timeout, rounded up; -1 (for ever) for None or a negative timeout."""
    if timeout_sec is None or timeout_sec < 0:
        return -1
    return wait_ns(float(timeout_sec))
