"""``launch_ros.actions.LifecycleNode``: starts a program of a package as a managed node."""

from __future__ import annotations

from typing import Any

from sim.launch.launch_ros.actions.node import Node


class LifecycleNode(Node):
    """Starts a managed node; as in launch_ros, its name and namespace are required.

    It stays unconfigured until a transition is requested, as by ``ros2 lifecycle set``.
    """

    def __init__(self, *, name: Any, namespace: Any, autostart: bool = False, **kwargs: Any) -> None:
        if autostart:
            raise NotImplementedError("LifecycleNode's autostart is not supported; use ros2 lifecycle set")
        super().__init__(name=name, namespace=namespace, **kwargs)
