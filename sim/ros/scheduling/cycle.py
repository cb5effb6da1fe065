"""What an executor serves next: the tasks that are due, then one snapshot of what is ready, to its end."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, TypeAlias

from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.wait_set import WaitSet

if TYPE_CHECKING:
    from sim.ros.scheduling.entity import OwnerNode
    from sim.ros.scheduling.task import Task

Work: TypeAlias = "Entity | Task[Any]"
"""What a cycle yields."""


class Cycle:
    """One cycle after another, over ``nodes`` or those of them that are in view. With the host's lock held.

    ``entity_of`` tells whose callback a task goes on with; None: nobody's. ``chosen`` may leave more out of a
    snapshot.
    """

    def __init__(
        self,
        nodes: list[OwnerNode],
        entity_of: Callable[[Task[Any]], Entity | None],
        chosen: Callable[[Entity], bool] | None,
    ) -> None:
        self.view = nodes
        """The nodes that are waited for."""
        self._nodes = nodes
        self._entity_of = entity_of
        self._is_chosen = chosen
        self.wanted: tuple[Any, ...] = ()
        """What is waited for: how long, over which nodes, and until which condition holds."""
        self._wait_set = WaitSet()
        self._tasks: deque[Task[Any]] = deque()
        self._due_tasks: deque[Task[Any]] = deque()
        self.foreign_awaits: list[Task[Any]] = []
        """Tasks that await something unknown: they ask again after the executor is next woken."""
        self._looked = True

    @property
    def served(self) -> bool:
        """Whether this cycle has been served to its end."""
        return self._looked and self._wait_set.exhausted and not self._due_tasks

    @property
    def about_to_look(self) -> bool:
        """Whether the next thing to do is to take a new snapshot."""
        return not self._due_tasks and self._wait_set.exhausted and not (self._looked and self._tasks)

    def want(self, wanted: tuple[Any, ...], nodes: Iterable[OwnerNode] | None) -> None:
        """Wait for something else than until now: the rest of the snapshot is let go.

        Raises:
            NotImplementedError: one of ``nodes`` is not served.
        """
        self.wanted = wanted
        self.view = self._nodes if nodes is None else self._chosen(nodes)
        self._tasks.extendleft(reversed(self._due_tasks))
        self._due_tasks.clear()
        self._wait_set.clear()
        self._looked = True

    def _chosen(self, nodes: Iterable[OwnerNode]) -> list[OwnerNode]:
        chosen = list(nodes)
        for node in chosen:
            if node not in self._nodes:
                raise NotImplementedError(
                    "wait_for_ready_callbacks(nodes=...) with a node that was not added is not supported"
                )
        return chosen

    def begin(self) -> None:
        """Begin a new cycle, with the tasks that are there now."""
        self._due_tasks, self._tasks = self._tasks, self._due_tasks
        if self.view is not self._nodes:
            self._put_tasks_off()
        self._looked = False

    def _put_tasks_off(self) -> None:
        """Leave the callbacks of nodes that are out of view for another cycle."""
        in_view: deque[Task[Any]] = deque()
        for task in self._due_tasks:
            entity = self._entity_of(task)
            is_seen = entity is None or entity.node in self.view
            (in_view if is_seen else self._tasks).append(task)
        self._due_tasks = in_view

    def next(self, now: int) -> Work | None:
        """The next of this cycle, an entity marked as handed out; None: it has been served to its end."""
        if self._due_tasks:
            return self._due_tasks.popleft()
        if not self._looked:
            self._looked = True
            self._wait_set.look(self.view, now)
            if self._is_chosen is not None:
                self._wait_set.keep(self._is_chosen)
        return self._wait_set.next(now)

    def add_task(self, task: Task[Any]) -> None:
        """Serve a task in the next cycle."""
        self._tasks.append(task)

    def recall_foreign_awaits(self) -> None:
        """The executor is woken: have the tasks that await something unknown ask again."""
        self._tasks.extend(self.foreign_awaits)
        self.foreign_awaits.clear()
