"""A wait set that a program fills and waits on itself, without an executor."""

from typing import cast

from sim.ros.context.context import Context
from sim.ros.entities.guard_condition import NodeGuardCondition
from sim.ros.exceptions import RCLError
from sim.ros.handle import Handle
from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.program_wait_set import ProgramWaitSet
from sim.ros.scheduling.waitable import NumberOfEntities
from sim.ros.scheduling.watched import Watcher


class BareWaitSet(ProgramWaitSet):
    """Waits for the announced numbers of entities; only one thread at a time may use it.

    It can wait for entities of a node only while no executor serves that node.
    """

    def __init__(self, *room: int | Handle) -> None:
        """``room``: the numbers of subscriptions, guard conditions, timers, clients, services and events,
        then the context's handle.
        """
        *numbers, context = room
        super().__init__(NumberOfEntities(*cast("list[int]", numbers)))
        owner: Context = cast("Handle", context).owner
        self._host = owner.host
        self._more = owner.host.clock.auto_reset_event()

    def clear_entities(self) -> None:
        """Remove all entities; the announced numbers stay."""
        for waited in self._waited.values():
            waited.clear()
        for ready in self._ready.values():
            ready.clear()

    def wait(self, timeout_nsec: int = -1) -> None:
        """Wait until an entity is ready, for at most ``timeout_nsec``; a negative timeout waits for ever.

        Raises:
            RCLError: the wait set is empty.
            NotImplementedError: an executor serves one of the entities.
        """
        if not any(self._waited.values()):
            raise RCLError("failed to wait on wait set: wait set is empty")
        clock = self._host.clock
        deadline = None if timeout_nsec < 0 else clock.now() + timeout_nsec
        while True:
            with self._host.lock:
                now = clock.now()
                due = self.check(self, now)
            if any(map(any, self._ready.values())) or (deadline is not None and now >= deadline):
                return
            self._more.wait(min((each for each in (due, deadline) if each is not None), default=None))

    def wake(self) -> None:
        """Make the waiting thread check again."""
        self._more.set()

    def _entity_is_ready(self, entity: Entity, watcher: Watcher, now: int) -> bool:
        agenda = entity.node._agenda
        if agenda.executor is not None:
            raise NotImplementedError("WaitSet: waiting for what an executor serves is not supported")
        agenda.watch(watcher)
        agenda.collect_due(now)
        ready = entity.pending and entity.still_ready(now)
        if isinstance(entity, NodeGuardCondition):
            entity.become_idle()
        return ready

    def _entity_due(self, entity: Entity) -> int | None:
        return entity.node._agenda.next_due()
