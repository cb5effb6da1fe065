"""Applies the set-up's changes to a program: callback groups, timers' periods, executors' threads."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup

from . import CHANGES
from .recorder import now

if TYPE_CHECKING:
    from .recorder import Recorder


class Tuning:
    """The set-up's changes, read from the environment and applied as the program creates its entities.

    A change for one node takes precedence over one for any node.
    """

    def __init__(self, recorder: Recorder) -> None:
        changes = json.loads(os.environ.get(CHANGES, "{}"))
        self.threads: int | None = changes.get("threads")
        self._recorder = recorder
        self._groups = {(node, callback): wish for node, callback, wish in changes.get("groups", ())}
        self._periods = {(node, callback): period for node, callback, period in changes.get("periods", ())}
        self._shared: dict[tuple[Any, str], Any] = {}

    @property
    def has_changes(self) -> bool:
        """Whether there are changes to what nodes create."""
        return bool(self._groups or self._periods)

    def change(self, node: Any, kind: str, name: str, arguments: dict[str, Any]) -> None:
        """Change the arguments with which a node creates an entity whose callback has that name."""
        full = node.get_fully_qualified_name()
        wish = _chosen(self._groups, full, name)
        if wish is not None:
            arguments["callback_group"] = self._group(node, wish)
        period = _chosen(self._periods, full, name)
        if kind == "timer" and period is not None:
            arguments["timer_period_sec"] = period / 1e9

    def tell_of_single_thread(self) -> None:
        """Report that an executor of the program's own class cannot have another number of threads."""
        if self.threads not in (None, 1):
            text = (
                f"the program's own executor cannot have {self.threads} threads on real ROS 2: "
                "make it a MultiThreadedExecutor in the code"
            )
            self._recorder.put("notice", now(), "WARN", text)

    def _group(self, node: Any, wish: str) -> Any:
        if wish == "default":
            return node.default_callback_group
        if wish == "own":
            return MutuallyExclusiveCallbackGroup()
        if (node, wish) not in self._shared:
            made = ReentrantCallbackGroup() if wish == "reentrant" else MutuallyExclusiveCallbackGroup()
            self._shared[node, wish] = made
        return self._shared[node, wish]


def _chosen(changes: dict[tuple[str, str], Any], node: str, callback: str) -> Any:
    """The change for a callback, by its name or by that without ``_callback``; None if there is none."""
    names = (callback, callback.removesuffix("_callback"))
    keys = ((place, name) for name in names for place in (node, ""))
    return next((changes[key] for key in keys if key in changes), None)
