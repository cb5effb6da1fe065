"""Entities of a launch description: what is visited, and actions."""

# ruff: noqa: D102 -- what a method does that overrides another stands with that one

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from sim.launch.errors import place_of_caller
from sim.launch.launch.condition import Condition
from sim.launch.launch.events import ExecutionComplete

if TYPE_CHECKING:
    from sim.launch.launch.launch_context import LaunchContext


@runtime_checkable
class LaunchDescriptionEntity(Protocol):
    """Something that a launch visits; what the visit gives is visited next."""

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Do what there is to do."""
        raise NotImplementedError(f"{type(self).__name__} does not implement visit()")

    def parts(self) -> Iterable[LaunchDescriptionEntity]:
        """The entities known to be inside, for those who look for declared arguments."""
        return ()


class Action:
    """Something that is done when it is reached, if its condition holds.

    ``place`` is the line of the launch file that made it.
    """

    def __init__(self, *, condition: Condition | None = None) -> None:
        if condition is not None and not isinstance(condition, Condition):
            raise TypeError(f"condition is wanted as an IfCondition or the like, not {condition!r}")
        self.place = place_of_caller()
        self._condition = condition

    @property
    def condition(self) -> Condition | None:
        """What decides whether it is done."""
        return self._condition

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        if self._condition is not None and not self._condition.evaluate(context):
            return None
        found = self.execute(context)
        if self.completes_at_once:
            context.emit_event(ExecutionComplete(action=self))
        return found

    def parts(self) -> Iterable[LaunchDescriptionEntity]:
        return ()

    completes_at_once = True
    """Whether nothing of it is left to do after ``execute``."""

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Do it; what is returned is visited next."""
        raise NotImplementedError(f"{type(self).__name__} does not implement execute()")
