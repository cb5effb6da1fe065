"""A model of rclpy: the same names, the same order of callbacks, and every reason for waiting on a trace.

``import rclpy`` means this package in an engine process (see ``sim.ros.importing``).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sim.ros.context import Context
from sim.ros.executors import Executor, SingleThreadedExecutor
from sim.ros.node import Node
from sim.ros.parameter import Parameter
from sim.ros.process import of_process
from sim.ros.signals import SignalHandlerOptions, install_signal_handlers
from sim.ros.task import Future
from sim.ros.utilities import (
    get_default_context,
    get_rmw_implementation_identifier,
    ok,
    shutdown,
    try_shutdown,
)

__all__ = [
    "Context",
    "Future",
    "Node",
    "Parameter",
    "SignalHandlerOptions",
    "create_node",
    "get_default_context",
    "get_global_executor",
    "get_rmw_implementation_identifier",
    "init",
    "ok",
    "shutdown",
    "spin",
    "spin_once",
    "spin_until_future_complete",
    "try_shutdown",
]


class _GlobalExecutor:
    """The executor that a process's ``spin`` uses, for its present default context."""

    def __init__(self) -> None:
        self.executor: Executor | None = None


def init(
    *,
    args: Sequence[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> Context:
    """Begin; ``args`` None means the program's own arguments.

    ``signal_handler_options`` None means all for the default context, none for another.

    Raises:
        RuntimeError: it was called before.
        RCLError, UnknownROSArgsError: a ROS argument cannot be read, or is none.
    """
    default = get_default_context()
    chosen = default if context is None else context
    if signal_handler_options is None:
        signal_handler_options = SignalHandlerOptions.ALL if chosen is default else SignalHandlerOptions.NO
    install_signal_handlers(signal_handler_options)
    chosen.init(args, domain_id=domain_id)
    return chosen


def create_node(
    node_name: str,
    *,
    context: Context | None = None,
    cli_args: Sequence[str] | None = None,
    namespace: str | None = None,
    use_global_arguments: bool = True,
    enable_rosout: bool = True,
    start_parameter_services: bool = True,
    parameter_overrides: list[Parameter[Any]] | None = None,
    allow_undeclared_parameters: bool = False,
    automatically_declare_parameters_from_overrides: bool = False,
    enable_logger_service: bool = False,
) -> Node:
    """Make a node; everything as for ``Node``."""
    return Node(
        node_name,
        context=context,
        cli_args=cli_args,
        namespace=namespace,
        use_global_arguments=use_global_arguments,
        enable_rosout=enable_rosout,
        start_parameter_services=start_parameter_services,
        parameter_overrides=parameter_overrides,
        allow_undeclared_parameters=allow_undeclared_parameters,
        automatically_declare_parameters_from_overrides=automatically_declare_parameters_from_overrides,
        enable_logger_service=enable_logger_service,
    )


def get_global_executor() -> Executor:
    """The single-threaded executor that ``spin`` uses."""
    context = get_default_context()
    own = of_process(_GlobalExecutor)
    if own.executor is None or own.executor.context is not context:
        own.executor = SingleThreadedExecutor(context=context)
    return own.executor


def spin(node: Node, executor: Executor | None = None) -> None:
    """Run the node's callbacks until the context ends.

    Raises:
        RuntimeError: the executor is already spinning.
        ExternalShutdownException: the context ended meanwhile.
    """
    chosen = get_global_executor() if executor is None else executor
    try:
        chosen.add_node(node)
        if chosen.context.ok():
            chosen.spin()
    finally:
        chosen.remove_node(node)


def spin_once(node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Run one of the node's callbacks, waiting at most ``timeout_sec`` seconds for it."""
    chosen = get_global_executor() if executor is None else executor
    try:
        chosen.add_node(node)
        chosen.spin_once(timeout_sec=timeout_sec)
    finally:
        chosen.remove_node(node)


def spin_until_future_complete(
    node: Node, future: Future[Any], executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run the node's callbacks until the future is done, for at most ``timeout_sec`` seconds."""
    chosen = get_global_executor() if executor is None else executor
    try:
        chosen.add_node(node)
        chosen.spin_until_future_complete(future, timeout_sec)
    finally:
        chosen.remove_node(node)
