"""How an executor serves the waitables of a program: each stands on its node's agenda by an entity."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from sim.ros.exceptions import InvalidHandle
from sim.ros.scheduling.entity import Entity, OwnerNode, Taken
from sim.ros.scheduling.program_wait_set import ProgramWaitSet
from sim.ros.scheduling.waitable import NumberOfEntities, Waitable
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.scheduling.executor import Executor


class WaitableEntity(Entity):
    """A program's waitable on its node's agenda.

    ``taking`` from the moment its handler begins until the waitable has taken its data; meanwhile it is not
    asked whether it is ready, for it would still say yes.
    """

    kind = EntityKind.WAITABLE
    rank = -1

    def __init__(self, node: OwnerNode, waitable: Waitable[Any]) -> None:
        super().__init__(node, type(waitable).__name__, waitable.callback_group)
        self.waitable = waitable
        self.taking = False

    def shown_callback(self) -> Any:
        """What the program wrote to be executed."""
        return self.waitable.execute

    def may_be_asked(self) -> bool:
        """Whether it is waited on in this cycle. With the host's lock held."""
        return not (self.handed_out or self.taking) and self.callback_group.can_execute(self)

    def take(self, now: int) -> Taken | None:
        """Begin; the waitable takes its data when the callback runs, without the lock."""
        if not self.pending:
            return None
        late = now - self.ready_since
        self.nothing_left()
        self.taking = True
        return Taken(None, 0, late, 0)

    def invoke(self, taken: Taken) -> Any:
        """Have the waitable take its data; returns the coroutine that executes."""
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
        self.node._agenda.remove_asked(self)


def ask_waitables(executor: Executor, nodes: Iterable[OwnerNode]) -> int | None:
    """Ask the waitables of nodes whether they are ready, for a cycle that is about to begin.

    Returns when the next of the timers that they wait for falls due. Without the host's lock held: what a
    program wrote may take locks of its own.
    """
    lock, now = executor._lock, executor._clock.now()
    with lock:
        asked = [each for node in nodes for each in node._agenda.asked if each.may_be_asked()]
    with ExitStack() as held:
        asked = [each for each in asked if _enter(held, each.waitable)]
        room = sum((each.waitable.get_num_entities() for each in asked), NumberOfEntities())
        wait_set = ProgramWaitSet(room)
        for each in asked:
            each.waitable.add_to_wait_set(wait_set)
        with lock:
            due = wait_set.look(executor, now)
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
