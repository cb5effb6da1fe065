"""Guard conditions: callbacks that a program sets off itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from sim.ros.entity import Entity, Taken
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.callback_groups import CallbackGroup
    from sim.ros.node import Node


class GuardCondition(Entity):
    """Calls back once after ``trigger``, however often it was triggered meanwhile."""

    kind = EntityKind.GUARD
    rank = 2

    def __init__(self, node: Node, callback: Callable[[], Any] | None, callback_group: CallbackGroup) -> None:
        super().__init__(node, "", callback_group)
        self.callback = callback
        self._host = node.context.host

    def trigger(self) -> None:
        """Have the callback run; InvalidHandle if it was destroyed."""
        self.require_alive()
        with self._host.lock:
            self.become_ready(self._host.clock.now())

    def shown_callback(self) -> Callable[..., Any] | None:
        """The callback."""
        return self.callback

    def take(self, now: int) -> Taken | None:
        """Take the trigger back."""
        if not self.pending:
            return None
        late = now - self.ready_since
        self.nothing_left()
        return Taken(None, 0, late, 0)

    def invoke(self, taken: Taken) -> Any:
        """Run the callback."""
        return None if self.callback is None else self.callback()

    def destroy(self) -> None:
        """Remove it from its node."""
        self.node.destroy_guard_condition(self)
