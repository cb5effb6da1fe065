"""The face of the model: the modules of rclpy.

``import rclpy`` imports this package in an engine process (see ``sim.ros.importing``). Its modules have
rclpy's names, and import their content from the model; ``_namesakes`` makes those that are a module of the
model as it is. A folder with a leading underscore groups modules; it is not part of their names.
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
from sim.ros.middleware.process import process_local
from sim.ros.node.node import Node
from sim.ros.parameters.parameter import Parameter
from sim.ros.rclpy import _namesakes
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


_namesakes.put_into(__name__)
__path__.extend(str(folder) for folder in sorted(Path(__path__[0]).glob("_[a-z]*/")))

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """A module of rclpy, also for a program that imports only ``rclpy``."""
        try:
            return import_module(f"{__name__}.{name}")
        except ModuleNotFoundError:
            raise AttributeError(f"module 'rclpy' has no attribute {name!r}") from None


class _GlobalExecutor:
    """The global executor of a process, for its present default context."""

    def __init__(self) -> None:
        self.executor: Executor | None = None


def init(
    *,
    args: Sequence[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> Any:
    """Initialise the context; ``args`` None means the program's own arguments.

    Returns an ``InitContextManager``, None in releases without ``with`` blocks.

    ``signal_handler_options`` None means all signals for the default context, and none for another.

    Raises:
        RuntimeError: the context was initialised before.
        RCLError, UnknownROSArgsError: a ROS argument cannot be read, or is unknown.
    """
    default = get_default_context()
    chosen = default if context is None else context
    if signal_handler_options is None:
        signal_handler_options = SignalHandlerOptions.ALL if chosen is default else SignalHandlerOptions.NO
    chosen.init(args, domain_id=domain_id)
    install_signal_handlers(signal_handler_options)
    return InitContextManager(chosen) if chosen.host.profile.has_with_blocks else None


class InitContextManager:
    """The result of ``init``; ``with rclpy.init():`` shuts the context down at the end of the block."""

    def __init__(self, context: Context) -> None:
        self.context = context

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        is_default = self.context is get_default_context()
        try_shutdown(context=None if is_default else self.context)


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """End the context. The signal handlers are removed; by default only for the default context.

    Raises:
        RuntimeError: the context is not initialised.
    """
    utilities.shutdown(context=context)
    _forget_signals(context, uninstall_handlers)


def try_shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Do as ``shutdown``, if the context is initialised and has not ended."""
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
    """Create a node; the arguments are those of ``Node``."""
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
    """The single-threaded executor of ``spin``."""
    context = get_default_context()
    own = process_local(_GlobalExecutor)
    if own.executor is None or own.executor.context is not context:
        own.executor = SingleThreadedExecutor(context=context)
    return own.executor


def spin(node: Node, executor: Executor | None = None) -> None:
    """Run the node's callbacks until the context ends.

    Raises:
        RuntimeError: the executor is already spinning.
        ExternalShutdownException: the context ended.
    """
    chosen = get_global_executor() if executor is None else executor
    try:
        chosen.add_node(node)
        if chosen.context.ok():
            chosen.spin()
    finally:
        chosen.remove_node(node)


def spin_once(node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Run one callback of the node; wait for at most ``timeout_sec`` seconds."""
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
    """The executor, which serves the node in this context."""
    chosen = get_global_executor() if executor is None else executor
    added = False
    try:
        added = chosen.add_node(node)
        yield chosen
    finally:
        if added or not chosen.context.host.profile.keeps_attached_nodes:
            chosen.remove_node(node)
