"""Guard conditions: callbacks that a program triggers itself."""

from collections.abc import Callable
from typing import Any, Self

from sim.ros.context.context import Context
from sim.ros.context.utilities import get_default_context
from sim.ros.handle import Handle
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import Entity, OwnerNode, TakenData
from sim.ros.scheduling.watched import BareEntity, Watcher
from sim.trace.events import EntityKind


class BareGuardCondition(BareEntity):
    """A flag without a callback. Any thread may set it; a wait clears it."""

    def __init__(self, context: Handle) -> None:
        owner: Context = context.owner
        self._host = owner.host

    def trigger_guard_condition(self) -> None:
        """Set the flag."""
        with self._host.lock:
            self.become_ready(self._host.clock.now())

    def check(self, watcher: Watcher, now: int) -> bool:
        """Whether the flag is set; this clears it. Called with the host's lock held."""
        ready = super().check(watcher, now)
        self.pending = False
        return ready


class GuardCondition:
    """A flag with a callback. Any thread may set it.

    A guard condition that a program creates itself belongs to no node: its callback never runs, but a wait
    set may wait for its handle. Executors serve those of ``Node.create_guard_condition``.
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
        """A handle that keeps the flag alive while it is used."""
        return Handle(self._flag)

    def trigger(self) -> None:
        """Set the flag; InvalidHandle if it was destroyed."""
        with self._flag:
            self._flag.trigger_guard_condition()

    def destroy(self) -> None:
        """Destroy the flag: ``trigger`` raises InvalidHandle from now on."""
        self._flag.destroy()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.destroy()


class NodeGuardCondition(Entity, GuardCondition):
    """A guard condition of a node: its callback runs once, even after several triggers before that."""

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
        """Let the executor run the callback; InvalidHandle if the guard condition was destroyed."""
        self.require_alive()
        with self._host.lock:
            self._triggered_again = True
            self.become_ready(self._host.clock.now())

    def on_snapshot(self) -> None:
        """A snapshot includes the guard condition: a later trigger makes it run once more."""
        self._triggered_again = False

    def take(self, now: int) -> TakenData | None:
        """Take the trigger."""
        if not self.pending:
            return None
        late = now - self.ready_since
        self.become_idle()
        if self._triggered_again:
            self.become_ready(now)
        return TakenData(None, 0, late, 0)

    def invoke(self, taken: TakenData) -> Any:
        """Run the callback."""
        return None if self.callback is None else self.callback()
