"""The base of conditions, which decide whether an action is carried out."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.launch.launch.launch_context import LaunchContext


class Condition:
    """A condition that is evaluated when an action is reached, by ``predicate``."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool] | None = None) -> None:
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether the condition holds."""
        return self._predicate is None or self._predicate(context)
