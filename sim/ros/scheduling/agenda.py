"""A node's agenda: its entities, which of them are ready, and when its timers are due.

It is an object of its own, so that a program's node, which inherits from ``Node``, cannot overwrite it
with attributes of the same names.
"""

import weakref
from heapq import heappop, heappush
from itertools import count
from types import CodeType
from typing import Any, TypeVar

from sim.probes.probe import Probe
from sim.ros.middleware.host import Host
from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.executors import Executor
from sim.ros.scheduling.waitable_entity import WaitableEntity
from sim.ros.scheduling.watched import Watcher
from sim.trace.events import Reason

EntityT = TypeVar("EntityT", bound="Entity")

numbers = count()
"""The order in which entities of all nodes become ready."""

MANY = 1_000
"""The number of entities of a node that is reported, if a callback made the last one."""


class Agenda:
    """The state of a node that its executor needs. Use it with the host's lock held."""

    def __init__(self, host: Host, probe: Probe) -> None:
        self.host = host
        self.entities: list[Entity] = []
        self.polled: list[WaitableEntity] = []
        """The waitables that the program wrote; an executor polls whether they are ready."""
        self.tasks: dict[CodeType, Any] = {}
        """What stands on the trace for functions of the program that run as tasks, by their code."""
        self._probe = probe
        self._orders = 0
        self.ready: dict[Entity, int] = {}
        """The ready entities, numbered in the order in which those of all nodes became ready."""
        self._timer_queue: list[tuple[int, int, Entity]] = []
        self._executor: weakref.ref[Executor] | None = None
        self._latest_executor: weakref.ref[Executor] | None = None
        self._watchers: dict[Watcher, None] = {}
        host.explain_waits_with(self.explain_waits)

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
        """The executor that serves the node, or served it last."""
        return None if self._latest_executor is None else self._latest_executor()

    def forget_executors(self) -> None:
        """Reset the present and the latest executor to None."""
        self._executor = self._latest_executor = None

    def next_order(self) -> int:
        """The next number in the order of creation."""
        self._orders += 1
        return self._orders

    def add(self, entity: Entity) -> None:
        """Add an entity."""
        self.entities.append(entity)
        if entity.traced and entity.shown_callback() is not None:
            entity.node.context.process.callbacks += 1
        self._probe.entity_made(entity)
        self.report_many(len(self.entities), "timers, subscriptions, services or clients")
        self.wake_executor()

    def report_many(self, number: int, kind: str) -> None:
        """Report a node whose callbacks create ever more entities, when their number reaches ``MANY``."""
        if number == MANY and self._probe.callback_here():
            self._probe.usage.many_made(number, kind)

    def remove(self, entity: Entity) -> bool:
        """Remove an entity; False if it was not on the agenda."""
        with self.host.lock:
            if entity not in self.entities:
                return False
            self.entities.remove(entity)
            entity.destroyed = True
            entity.become_idle()
            self._probe.entity_gone(entity)
            self.wake_executor()
            if self.executor is None or entity not in self.executor._registered:
                entity.removed()
        return True

    def add_polled(self, entity: WaitableEntity) -> None:
        """Add a waitable that has to be polled."""
        with self.host.lock:
            self.polled.append(entity)
            self._polled_changed()
            self.add(entity)

    def remove_polled(self, entity: WaitableEntity) -> None:
        """Remove a waitable that had to be polled."""
        with self.host.lock:
            self.polled.remove(entity)
            self._polled_changed()
            self.remove(entity)

    def _polled_changed(self) -> None:
        executor = self.executor
        if executor is not None:
            executor._waitables_changed()

    def found(self, entity: WaitableEntity, *, ready: bool, now: int) -> None:
        """Record what an executor found when it polled a waitable."""
        if not ready:
            entity.become_idle()
        elif not (entity.pending or entity.destroyed):
            entity.pending = True
            entity.ready_since = now
            self.ready[entity] = next(numbers)

    def of(self, kind: type[EntityT]) -> tuple[EntityT, ...]:
        """The entities of a class, oldest first."""
        return tuple(each for each in tuple(self.entities) if isinstance(each, kind))

    def entity_ready(self, entity: Entity) -> None:
        """An entity became ready."""
        self.ready[entity] = next(numbers)
        executor = self.executor
        if executor is not None:
            executor._entity_ready(entity)
        else:
            self._wake_watchers()

    def entity_has_more(self, entity: Entity) -> None:
        """A ready entity has more to take."""
        executor = self.executor
        if executor is not None:
            executor._entity_has_more(entity)

    def entity_idle(self, entity: Entity) -> None:
        """An entity is no longer ready."""
        self.ready.pop(entity, None)
        self._probe.wait_ended(entity)

    def timer_set(self, timer: Entity) -> None:
        """A timer has a new due time."""
        heappush(self._timer_queue, (timer.due, timer.order, timer))
        executor = self.executor
        if executor is not None:
            executor._timer_set(timer)
        else:
            self._wake_watchers()

    def watch(self, watcher: Watcher) -> None:
        """Wake ``watcher`` once an entity becomes ready without an executor, or an executor is assigned."""
        self._watchers[watcher] = None

    def _wake_watchers(self) -> None:
        if self._watchers:
            watchers = tuple(self._watchers)
            self._watchers.clear()
            for each in watchers:
                each.wake()

    def collect_due(self, now: int) -> dict[Entity, int]:
        """The ready entities, including the timers that are due."""
        while (due := self.next_due()) is not None and due <= now:
            timer = heappop(self._timer_queue)[2]
            timer.pending = True
            timer.ready_since = due
            self.ready[timer] = next(numbers)
        return self.ready

    def next_due(self) -> int | None:
        """The due time of the next timer that is not ready yet; None without such a timer."""
        queue = self._timer_queue
        while queue:
            due, _, timer = queue[0]
            if timer.falls_due(due):
                return due
            heappop(queue)
        return None

    def wake_executor(self) -> None:
        """Make the executor check again what is ready."""
        executor = self.executor
        if executor is not None:
            executor.wake()

    def explain_waits(self) -> int | None:
        """Record which callbacks wait, and why; return when the next timer is due."""
        if not self._probe.visible:
            return None
        executor = self.executor
        now = self.host.clock.now()
        for entity in self.collect_due(now):
            if not entity.queued:
                continue  # foreign replies: nothing that a program has wait
            if executor is None:
                self._probe.waits(entity, Reason.NOBODY_SPINS, None, busy=False, began=now)
            else:
                executor._runner.explain_wait(entity)
        return self.next_due()
