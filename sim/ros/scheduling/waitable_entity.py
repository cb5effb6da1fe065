"""Serves the waitables of a program: each has an entity on its node's agenda."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from sim.ros.exceptions import InvalidHandle
from sim.ros.scheduling.entity import Entity, OwnerNode, TakenData
from sim.ros.scheduling.program_wait_set import ProgramWaitSet
from sim.ros.scheduling.waitable import NumberOfEntities, Waitable
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.scheduling.executor import Executor


class WaitableEntity(Entity):
    """The entity of a program's waitable.

    ``taking``: its handler has started, and the waitable has not taken its data yet; meanwhile it is not
    polled, because it would still be ready.
    """

    kind = EntityKind.WAITABLE
    rank = -1

    def __init__(self, node: OwnerNode, waitable: Waitable[Any]) -> None:
        super().__init__(node, type(waitable).__name__, waitable.callback_group)
        self.waitable = waitable
        self.taking = False

    def shown_callback(self) -> Any:
        """The waitable's ``execute``."""
        return self.waitable.execute

    def may_be_polled(self) -> bool:
        """Whether the executor polls it in this cycle. Called with the host's lock held."""
        return not (self.handed_out or self.taking) and self.callback_group.can_execute(self)

    def take(self, now: int) -> TakenData | None:
        """Start; the waitable takes its data later, without the lock, when the callback runs."""
        if not self.pending:
            return None
        late = now - self.ready_since
        self.become_idle()
        self.taking = True
        return TakenData(None, 0, late, 0)

    def invoke(self, taken: TakenData) -> Any:
        """Let the waitable take its data; return the coroutine that executes."""
        try:
            data = self.waitable.take_data()
        finally:
            with self.node.context.host.lock:
                self.taking = False
                self.node._agenda.wake_executor()
        return self._execute(data)

    async def _execute(self, data: Any) -> None:
        executor = self.node.executor
        if executor is not None:
            for future in self.waitable._futures:
                future._set_executor(executor)
        await self.waitable.execute(data)

    def destroy(self) -> None:
        """Remove it from its node."""
        self.node._agenda.remove_polled(self)


def poll_waitables(executor: Executor, nodes: Iterable[OwnerNode]) -> int | None:
    """Poll whether the waitables of nodes are ready, for a cycle that is about to begin.

    Return when the next of their timers is due. Called without the host's lock, because a program's
    code may take locks of its own.
    """
    lock, now = executor._lock, executor._clock.now()
    with lock:
        asked = [each for node in nodes for each in node._agenda.polled if each.may_be_polled()]
    with ExitStack() as held:
        asked = [each for each in asked if _enter(held, each.waitable)]
        room = sum((each.waitable.get_num_entities() for each in asked), NumberOfEntities())
        wait_set = ProgramWaitSet(room)
        for each in asked:
            each.waitable.add_to_wait_set(wait_set)
        with lock:
            due = wait_set.check(executor, now)
        for each in asked:
            ready = each.waitable.is_ready(wait_set)
            with lock:
                each.node._agenda.found(each, ready=ready, now=now)
    return due


def _enter(held: ExitStack, waitable: Waitable[Any]) -> bool:
    try:
        held.enter_context(waitable)
    except InvalidHandle:
        return False
    return True
