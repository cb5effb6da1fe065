"""A model of rclpy: the same names, the same order of callbacks, and every reason for waiting on a trace.

``import rclpy`` means this package in an engine process (see ``sim.ros.importing``).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sim.ros.context import Context
from sim.ros.executors import Executor, SingleThreadedExecutor
from sim.ros.node import Node
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

_global_executors: dict[Context, Executor] = {}


def init(
    *,
    args: Sequence[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
) -> Context:
    """Begin; ``args`` None means the program's own arguments.

    Raises:
        RuntimeError: it was called before.
    """
    chosen = get_default_context() if context is None else context
    chosen.init(args, domain_id=domain_id)
    return chosen


def create_node(node_name: str, *, context: Context | None = None, namespace: str | None = None) -> Node:
    """Make a node."""
    return Node(node_name, context=context, namespace=namespace)


def get_global_executor() -> Executor:
    """The single-threaded executor that ``spin`` uses."""
    context = get_default_context()
    if context not in _global_executors:
        _global_executors.clear()
        _global_executors[context] = SingleThreadedExecutor(context=context)
    return _global_executors[context]


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
