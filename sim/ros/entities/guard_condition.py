"""Guard conditions: callbacks that a program sets off itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Self

from sim.ros.context.utilities import get_default_context
from sim.ros.handle import Handle
from sim.ros.scheduling.entity import Entity, OwnerNode, Taken
from sim.ros.scheduling.watched import BareEntity, Watcher
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.context.context import Context
    from sim.ros.scheduling.callback_groups import CallbackGroup


class BareGuardCondition(BareEntity):
    """A flag that any thread raises, and that waiting for it takes down."""

    def __init__(self, context: Handle) -> None:
        owner: Context = context.owner
        self._host = owner.host

    def trigger_guard_condition(self) -> None:
        """Raise it."""
        with self._host.lock:
            self.become_ready(self._host.clock.now())

    def look(self, watcher: Watcher, now: int) -> bool:
        """Whether it is raised; it no longer is afterwards. With the host's lock held."""
        ready = super().look(watcher, now)
        self.pending = False
        return ready


class GuardCondition:
    """A flag that any thread raises, and its callback.

    One that a program makes itself belongs to no node: nobody runs the callback, but a wait set may wait for
    the handle. Those that executors serve come from ``Node.create_guard_condition``.
    """

    def __init__(
        self,
        callback: Callable[[], Any] | None,
        callback_group: CallbackGroup | None,
        context: Context | None = None,
    ) -> None:
        owner = get_default_context() if context is None else context
        self.callback = callback
        self.callback_group: Any = callback_group
        self._flag = BareGuardCondition(owner.handle)

    @property
    def handle(self) -> Handle:
        """What keeps it alive while it is used."""
        return Handle(self._flag)

    def trigger(self) -> None:
        """Raise the flag; InvalidHandle if it was destroyed."""
        with self._flag:
            self._flag.trigger_guard_condition()

    def destroy(self) -> None:
        """Let it be triggered no more."""
        self._flag.destroy()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.destroy()


class NodeGuardCondition(Entity, GuardCondition):
    """Calls back once after ``trigger``, however often it was triggered before an executor saw that."""

    kind = EntityKind.GUARD
    rank = 2

    def __init__(
        self, node: OwnerNode, callback: Callable[[], Any] | None, callback_group: CallbackGroup
    ) -> None:
        super().__init__(node, "", callback_group)
        self.callback = callback
        self._host = node.context.host
        self._triggered_again = False

    def trigger(self) -> None:
        """Have the callback run; InvalidHandle if it was destroyed."""
        self.require_alive()
        with self._host.lock:
            self._triggered_again = True
            self.become_ready(self._host.clock.now())

    def noticed(self) -> None:
        """A snapshot names it: from here on a trigger has it run once more."""
        self._triggered_again = False

    def shown_callback(self) -> Callable[..., Any] | None:
        """The callback."""
        return self.callback

    def take(self, now: int) -> Taken | None:
        """Take the trigger back."""
        if not self.pending:
            return None
        late = now - self.ready_since
        self.nothing_left()
        if self._triggered_again:
            self.become_ready(now)
        return Taken(None, 0, late, 0)

    def invoke(self, taken: Taken) -> Any:
        """Run the callback."""
        return None if self.callback is None else self.callback()
