"""A model of rclpy: the same names, the same order of callbacks, and every reason for waiting on a trace.

``import rclpy`` means this package in an engine process (see ``sim.ros.importing``). Its modules are rclpy's,
and say where the model has what they offer. A folder that begins with an underscore only groups modules:
it is not part of their names.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from sim.ros.context import utilities
from sim.ros.context.context import Context
from sim.ros.context.signals import SignalHandlerOptions, install_signal_handlers, uninstall_signal_handlers
from sim.ros.context.utilities import get_default_context, get_rmw_implementation_identifier, ok
from sim.ros.middleware.process import of_process
from sim.ros.node.node import Node
from sim.ros.parameters.parameter import Parameter
from sim.ros.scheduling.executors import Executor, SingleThreadedExecutor
from sim.ros.scheduling.task import Future

__all__ = [
    "Context",
    "Future",
    "InitContextManager",
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


__path__.extend(str(folder) for folder in sorted(Path(__path__[0]).glob("_[a-z]*/")))

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """A module of rclpy, also for a program that imports no more than ``rclpy``."""
        try:
            return import_module(f"{__name__}.{name}")
        except ModuleNotFoundError:
            raise AttributeError(f"module 'rclpy' has no attribute {name!r}") from None


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
) -> Any:
    """Begin; ``args`` None means the program's own arguments.

    Returns an ``InitContextManager``, None in releases without ``with`` blocks.

    ``signal_handler_options`` None means all for the default context, none for another.

    Raises:
        RuntimeError: it was called before.
        RCLError, UnknownROSArgsError: a ROS argument cannot be read, or is none.
    """
    default = get_default_context()
    chosen = default if context is None else context
    if signal_handler_options is None:
        signal_handler_options = SignalHandlerOptions.ALL if chosen is default else SignalHandlerOptions.NO
    chosen.init(args, domain_id=domain_id)
    install_signal_handlers(signal_handler_options)
    return InitContextManager(chosen) if chosen.host.profile.has_with_blocks else None


class InitContextManager:
    """What ``init`` returns; ``with rclpy.init():`` ends the context at the block's end."""

    def __init__(self, context: Context) -> None:
        self.context = context

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        is_default = self.context is get_default_context()
        try_shutdown(context=None if is_default else self.context)


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """End the context; signals are handled no more, by default if it is the default context.

    Raises:
        RuntimeError: it has not begun.
    """
    utilities.shutdown(context=context)
    _forget_signals(context, uninstall_handlers)


def try_shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Do as ``shutdown``, if the context has begun and not ended."""
    utilities.try_shutdown(context=context)
    _forget_signals(context, uninstall_handlers)


def _forget_signals(context: Context | None, wanted: bool | None) -> None:
    if wanted or (wanted is None and context is None):
        uninstall_signal_handlers()


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
    with _attached(node, executor) as chosen:
        chosen.spin_once(timeout_sec=timeout_sec)


def spin_until_future_complete(
    node: Node, future: Future[Any], executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run the node's callbacks until the future is done, for at most ``timeout_sec`` seconds."""
    with _attached(node, executor) as chosen:
        chosen.spin_until_future_complete(future, timeout_sec)


@contextmanager
def _attached(node: Node, executor: Executor | None) -> Generator[Executor, None, None]:
    """The executor, which serves the node meanwhile."""
    chosen = get_global_executor() if executor is None else executor
    added = False
    try:
        added = chosen.add_node(node)
        yield chosen
    finally:
        if added or not chosen.context.host.profile.keeps_attached_nodes:
            chosen.remove_node(node)
