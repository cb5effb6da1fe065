"""A node's agenda: its entities, which of them have something to take, and when its timers fall due.

It is an object of its own so that a program's node, which inherits from ``Node``, cannot overwrite any of it
with attributes of the same names.
"""

from __future__ import annotations

import weakref
from heapq import heappop, heappush
from typing import TYPE_CHECKING, TypeVar

from sim.ros.middleware.host import Host
from sim.trace.events import Reason

if TYPE_CHECKING:
    from sim.probes.probe import Probe
    from sim.ros.scheduling.entity import Entity
    from sim.ros.scheduling.executors import Executor
    from sim.ros.scheduling.waitable_entity import WaitableEntity
    from sim.ros.scheduling.watched import Watcher

EntityT = TypeVar("EntityT", bound="Entity")


MANY = 1_000
"""So many entities of a node, the last one made by a callback, are told of: it will not be the last."""


class Agenda:
    """What an executor has to know of a node. Used with the host's lock held."""

    def __init__(self, host: Host, probe: Probe) -> None:
        self.host = host
        self.entities: list[Entity] = []
        self.asked: list[WaitableEntity] = []
        """The waitables that a program wrote: an executor asks them whether they are ready."""
        self._probe = probe
        self._orders = 0
        self._pending: dict[Entity, None] = {}
        self._timer_queue: list[tuple[int, int, Entity]] = []
        self._executor: weakref.ref[Executor] | None = None
        self._latest_executor: weakref.ref[Executor] | None = None
        self._watchers: dict[Watcher, None] = {}
        host.explain_waits_of(self)

    @property
    def executor(self) -> Executor | None:
        """The executor that serves the node, if any."""
        return None if self._executor is None else self._executor()

    @executor.setter
    def executor(self, executor: Executor | None) -> None:
        self._executor = None if executor is None else weakref.ref(executor)
        if executor is not None:
            self._latest_executor = self._executor
            self._wake_watchers()

    @property
    def latest_executor(self) -> Executor | None:
        """The executor that served the node last, or does still."""
        return None if self._latest_executor is None else self._latest_executor()

    def forget_executors(self) -> None:
        """Be served by none, as if that had always been so."""
        self._executor = self._latest_executor = None

    def next_order(self) -> int:
        """The place of another entity in the order of creation."""
        self._orders += 1
        return self._orders

    def add(self, entity: Entity) -> None:
        """Take in an entity."""
        self.entities.append(entity)
        if entity.traced and entity.shown_callback() is not None:
            entity.node.context.process.callbacks += 1
        self._probe.entity_made(entity)
        self.has_now(len(self.entities), "timers, subscriptions, services or clients")
        self.wake_executor()

    def has_now(self, number: int, kind: str) -> None:
        """Tell, as the number grows to ``MANY``, of a node whose callbacks make ever more of a kind."""
        if number == MANY and self._probe.callback_here():
            self._probe.many_made(number, kind)

    def remove(self, entity: Entity) -> bool:
        """Let an entity go; whether it was there."""
        with self.host.lock:
            if entity not in self.entities:
                return False
            self.entities.remove(entity)
            entity.destroyed = True
            entity.nothing_left()
            self._probe.entity_gone(entity)
            self.wake_executor()
            entity.removed()
        return True

    def add_asked(self, entity: WaitableEntity) -> None:
        """Take in a waitable that has to be asked."""
        with self.host.lock:
            self.asked.append(entity)
            self._tell_of_asked()
            self.add(entity)

    def remove_asked(self, entity: WaitableEntity) -> None:
        """Let a waitable go that had to be asked."""
        with self.host.lock:
            self.asked.remove(entity)
            self._tell_of_asked()
            self.remove(entity)

    def _tell_of_asked(self) -> None:
        executor = self.executor
        if executor is not None:
            executor._waitables_changed()

    def found(self, entity: WaitableEntity, *, ready: bool, now: int) -> None:
        """An executor that looks at what is ready has asked a waitable."""
        if not ready:
            entity.nothing_left()
        elif not (entity.pending or entity.destroyed):
            entity.pending = True
            entity.ready_since = now
            self._pending[entity] = None

    def of(self, kind: type[EntityT]) -> tuple[EntityT, ...]:
        """The entities of a kind, oldest first."""
        return tuple(each for each in tuple(self.entities) if isinstance(each, kind))

    def entity_ready(self, entity: Entity) -> None:
        """An entity has something to take."""
        self._pending[entity] = None
        executor = self.executor
        if executor is not None:
            executor._entity_ready(entity)
        else:
            self._wake_watchers()

    def entity_has_more(self, entity: Entity) -> None:
        """An entity that is ready has more to take."""
        executor = self.executor
        if executor is not None:
            executor._entity_has_more(entity)

    def entity_idle(self, entity: Entity) -> None:
        """An entity has nothing more to take."""
        self._pending.pop(entity, None)
        self._probe.wait_ended(entity)

    def timer_set(self, timer: Entity) -> None:
        """A timer has another due time."""
        heappush(self._timer_queue, (timer.due, timer.order, timer))
        executor = self.executor
        if executor is not None:
            executor._timer_set(timer)
        else:
            self._wake_watchers()

    def watch(self, watcher: Watcher) -> None:
        """Wake ``watcher`` once more is ready while no executor serves the node, or one begins to."""
        self._watchers[watcher] = None

    def _wake_watchers(self) -> None:
        if self._watchers:
            watchers = tuple(self._watchers)
            self._watchers.clear()
            for each in watchers:
                each.wake()

    def collect_due(self, now: int) -> dict[Entity, None]:
        """Everything that has something to take, once the timers that are due are among it."""
        while (due := self.next_due()) is not None and due <= now:
            timer = heappop(self._timer_queue)[2]
            timer.pending = True
            timer.ready_since = due
            self._pending[timer] = None
        return self._pending

    def next_due(self) -> int | None:
        """When the next timer that is not due yet falls due; None without one."""
        queue = self._timer_queue
        while queue:
            due, _, timer = queue[0]
            if timer.falls_due(due):
                return due
            heappop(queue)
        return None

    def wake_executor(self) -> None:
        """Have the executor look again at what is ready."""
        executor = self.executor
        if executor is not None:
            executor.wake()

    def explain_waits(self) -> int | None:
        """Record which callbacks wait, and why; returns when the next timer falls due."""
        if not self._probe.visible:
            return None
        executor = self.executor
        for entity in self.collect_due(self.host.clock.now()):
            if executor is None:
                self._probe.waits(entity, Reason.NOBODY_SPINS, None, workers_busy=False)
            else:
                executor._runner.explain_wait(entity)
        return self.next_due()
