"""The work that an executor serves next: the tasks that are due, then one whole snapshot of ready entities.

A cycle begins with a gathering: the executor waits for every entity that is not handed out and that its group
admits. The first ready entities end the wait, and are served before the next gathering. So an entity that was
left out, because its group was busy or it was still handed out, comes one snapshot later, even if it could
run.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from enum import Enum, auto
from itertools import count
from typing import Any, TypeAlias

from sim.clock import RunClock
from sim.releases.profile import Profile
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import Entity, OwnerNode
from sim.ros.scheduling.pool import Pool
from sim.ros.scheduling.task import Task, task_numbers
from sim.ros.scheduling.wait_set import in_order_of_readiness, snapshot

Work: TypeAlias = "Entity | Task[Any]"
"""The work that a cycle yields."""
_gatherings = count(1)
"""Numbers the gatherings of all executors, because entities move between executors."""


class _Following(Enum):
    """The next step once all found work is served."""

    TASKS = auto()
    """Start a new cycle with its tasks."""
    GATHERING = auto()
    """Gather what can run: the tasks of this cycle are served."""
    WAITING = auto()
    """Wait for what was gathered."""


# Module constants, because every callback reads them several times and looking up an enum member is slow.
TASKS, GATHERING, WAITING = _Following


class Cycle:
    """The cycles of one executor over ``nodes``. Use it with the host's lock held.

    ``entity_of`` returns the entity whose callback a task continues, or None. ``chosen`` may leave further
    entities out of a snapshot.
    """

    def __init__(
        self,
        nodes: list[OwnerNode],
        clock: RunClock,
        entity_of: Callable[[Task[Any]], Entity | None],
        chosen: Callable[[Entity], bool] | None,
        profile: Profile,
    ) -> None:
        self.view = nodes
        """The nodes that are waited for."""
        self.pool: Pool | None = None
        """The workers that run what is served; None: nothing runs while the executor waits."""
        self._nodes = nodes
        self._clock = clock
        self._entity_of = entity_of
        self._is_chosen = chosen
        self._newest_task_first = profile.newest_task_first
        self._asks_tasks_again = not profile.resumes_at_once
        self.wanted: tuple[Any, ...] = ()
        """The present wait: its timeout, its nodes, and the condition that ends it."""
        self._snapshot: deque[Entity] = deque()
        self._tasks: deque[Task[Any]] = deque()
        self._due_tasks: deque[Task[Any]] = deque()
        self._fresh_tasks: tuple[Task[Any], ...] = ()
        """The tasks of the present cycle, where they come before what it hands over again."""
        self.foreign_awaits: list[Task[Any]] = []
        """Tasks that await something unknown; they are resumed when the executor is next woken."""
        self._following = TASKS
        self.held = False
        """Whether the found work waits until it may be served."""
        self._found_all = False
        """Whether the result of ``next`` is from a snapshot of all entities that were ready."""
        self._yielded = False
        self._gathering = next(_gatherings)
        self._groups_left_out: set[CallbackGroup] = set()
        self._woken_in: int | None = None

    @property
    def about_to_look(self) -> bool:
        """Whether the next step is to take a new snapshot."""
        is_served = not (self._due_tasks or self._snapshot)
        return is_served and not (self._tasks and self._following is TASKS)

    @property
    def waits(self) -> bool:
        """Whether all found work is served, and the executor waits for what was gathered."""
        return self._following is WAITING

    def set_wanted(self, wanted: tuple[Any, ...], nodes: Iterable[OwnerNode] | None) -> None:
        """Change the present wait, and drop the rest of the snapshot.

        Raises:
            NotImplementedError: one of ``nodes`` was not added to the executor.
        """
        self.wanted = wanted
        self.view = self._nodes if nodes is None else self._chosen(nodes)
        self._tasks.extendleft(reversed(self._due_tasks))
        self._due_tasks.clear()
        self._snapshot.clear()
        self._following = TASKS
        self.held = self._yielded = False

    def _chosen(self, nodes: Iterable[OwnerNode]) -> list[OwnerNode]:
        chosen = list(nodes)
        for node in chosen:
            if node not in self._nodes:
                raise NotImplementedError(
                    "wait_for_ready_callbacks(nodes=...) with a node that was not added is not supported"
                )
        return chosen

    # What is served next

    def next(self, now: int) -> Work | None:
        """The next work, with its entity marked as handed out; None: nothing may be served now."""
        self._found_all = False
        if self.held:
            if not self._released():
                return None
            self._find_more(now)
        for _ in _STAGES:
            work = self._serve(now)
            if work is not None:
                return work
            if not self._find(now) or not (self._due_tasks or self._released() or self._goes_ahead()):
                return None
        work = self._serve(now)
        if work is None:
            self._following = WAITING
        return work

    def _released(self) -> bool:
        """Whether found work may be served; otherwise hold it until it may."""
        self.held = self.pool is not None and not self.pool.may_serve()
        return not self.held

    def _goes_ahead(self) -> bool:
        """Whether the executor serves what it found though workers have not begun what was served before.

        They wait for the interpreter, which the executor seldom gives away if its wait returns at once.
        """
        pool = self.pool
        if pool is None or not pool.may_go_ahead() or not (pool.kept_busy() or self._clock.choose(2)):
            return False
        self.held = False
        return True

    def _find_more(self, now: int) -> None:
        """Add what came until now, if rclpy's wait, which needs no interpreter, lasts so long (to 1 ms)."""
        if self._snapshot and not self._yielded:
            found = self._awaited(self._ready(now))
            if len(found) > len(self._snapshot) and self._clock.choose(2):
                self._name(found)

    def next_found(self, now: int) -> Work | None:
        """The next work that is found already; None: all is served, or none may be served yet."""
        return None if self.held else self._serve(now)

    def snapshot_ended(self, now: int) -> bool:
        """Whether a snapshot served in part is at its end; if not, the rest stays. Call it once for each."""
        if self._due_tasks:
            return False
        if self._following is GATHERING:
            return not self._gather(self._ready(now))
        ends = self._yielded and not self._holds(now)
        if ends:
            self._yielded = False
        return ends

    def gather(self, now: int) -> bool:
        """Gather if all found work is served; return whether there is work to serve.

        Tasks are served at once. Other work is held until it may be served, unless the executor is kept busy.
        """
        if not (self._due_tasks or self._snapshot):
            self._ask_again()
            if not self._found_all or self._tasks:
                found = self._find(now)
            else:
                begins = self._following is TASKS or not self._newest_task_first
                found = not (begins and self._starts_worker()) and self._gather(deque())
            if self.held:
                return True
            self.held = found and not (self._due_tasks or self._goes_ahead())
        return self._following is not WAITING

    def would_find(self, now: int) -> bool:
        """Whether there is work to serve, or would be after a gathering now."""
        return bool(self._due_tasks or self._tasks or self._snapshot or snapshot(self.view, now))

    def hold(self) -> None:
        """Hold the rest of the found work until it may be served."""
        self.held = True

    def _serve(self, now: int) -> Work | None:
        if self._due_tasks:
            return self._due_tasks.popleft()
        if not (self._snapshot and self._holds(now)):
            return None
        entity = self._snapshot.popleft()
        entity.handed_out = self._yielded = True
        entity.task_number = next(task_numbers)
        return entity

    def _holds(self, now: int) -> bool:
        """Whether the snapshot has an entity that can still run; the entities before it are dropped."""
        found = self._snapshot
        while found:
            entity = found[0]
            if (
                not entity.handed_out
                and entity.still_ready(now)
                and entity.callback_group.can_execute(entity)
            ):
                return True
            found.popleft()
        return False

    def _find(self, now: int) -> bool:
        """Find the next work: what was waited for, else tasks, else the result of a new gathering."""
        following, self._following = self._following, TASKS
        if following is TASKS:
            self._ask_again()
            if self._newest_task_first and self._starts_worker():
                return False
            if self._take_tasks():
                return True
        if following is not WAITING and not self._newest_task_first and self._starts_worker():
            return False
        found = self._ready(now)
        if following is WAITING and (awaited := self._end_of_wait(self._awaited(found))) is not None:
            if awaited:
                self._name(awaited)
                self._found_all = len(awaited) == len(found)
                return True
            if self._take_tasks():
                return True
        # Tasks that came meanwhile end the waiting as it begins.
        return self._gather(found) or self._take_tasks()

    def _starts_worker(self) -> bool:
        """Whether a cycle starts a worker for what has not begun; until the worker begins, nothing is served.

        That is newer than the tasks that are due, so it comes first where the newest do. The cycle has no
        tasks that come later, for rclpy copies its list of them first.
        """
        fresh, self._fresh_tasks = self._fresh_tasks, ()
        if self.pool is None or not self.pool.hand_over_again(fresh):
            return False
        if self._newest_task_first:
            self._take_tasks()
        self._following = GATHERING
        return not self._released()

    def _end_of_wait(self, awaited: deque[Entity]) -> deque[Entity] | None:
        """What the wait found, of all that it could; None: it ended, and another one began, before that.

        The wake-up of the executor, for example by the start of a callback, races with what comes then: the
        wait finds the first of that, or nothing, and the executor may get the interpreter much later.
        """
        if self._woken_in is None and not self._tasks:
            return awaited
        fewest = 0 if self._tasks else 1
        chosen = self._clock.choose(2 + max(len(awaited) - fewest, 0))
        if chosen < 2:
            return None if chosen else awaited
        first = set(in_order_of_readiness(awaited)[: chosen - 2 + fewest])
        return deque(each for each in awaited if each in first)

    def _ready(self, now: int) -> deque[Entity]:
        found = snapshot(self.view, now)
        return found if self._is_chosen is None else deque(filter(self._is_chosen, found))

    def _gather(self, found: deque[Entity]) -> bool:
        """Start to wait for all that can run, of which ``found`` is ready; return whether it is not empty."""
        self._following = TASKS if found else WAITING
        self._yielded = False
        self._found_all = True
        self._regather()
        self._name(found)
        return bool(found)

    def _name(self, found: deque[Entity]) -> None:
        for each in found:
            each.on_snapshot()
        self._snapshot = found

    def _awaited(self, found: deque[Entity]) -> deque[Entity]:
        """The ready entities that the present wait includes."""
        gathering, groups = self._gathering, self._groups_left_out
        return deque(
            each for each in found if each.entered_in != gathering and each.callback_group not in groups
        )

    def _take_tasks(self) -> bool:
        """Make the present tasks of nodes in view due; return whether there are any."""
        if not self._tasks:
            return False
        self._due_tasks, self._tasks = self._tasks, self._due_tasks
        if self.view is not self._nodes:
            self._put_tasks_off()
        # rclpy keeps tasks in one list until they are done.
        if self._asks_tasks_again and len(self._due_tasks) > 1:
            self._due_tasks = deque(sorted(set(self._due_tasks), key=lambda task: task.number))
        if self._newest_task_first:
            self._due_tasks.reverse()
        else:
            self._fresh_tasks = tuple(self._due_tasks)
        if self._due_tasks:
            self._following = GATHERING
        return bool(self._due_tasks)

    def _put_tasks_off(self) -> None:
        """Leave the callbacks of nodes that are not in view for another cycle."""
        in_view: deque[Task[Any]] = deque()
        for task in self._due_tasks:
            entity = self._entity_of(task)
            is_seen = entity is None or entity.node in self.view
            (in_view if is_seen else self._tasks).append(task)
        self._due_tasks = in_view

    # What the present wait leaves out

    def stop_waiting(self) -> None:
        """Stop waiting for what was gathered."""
        self.held = False
        if self.waits:
            self._following = TASKS

    def entered(self, entity: Entity) -> None:
        """A handler starts: its entity was handed out, and the executor is woken."""
        self.woken()
        entity.entered_in = self._gathering

    def leaving(self, entity: Entity) -> None:
        """A callback is about to leave its group, and to wake the executor."""
        self.woken()
        if entity.entered_in != self._gathering:
            group = entity.callback_group
            if not group.can_execute(entity):
                self._groups_left_out.add(group)

    def woken(self) -> None:
        """The executor gathers again as soon as the running thread waits.

        If it has done so without finding anything, this gathers now.
        """
        turn = self._clock.turn
        if turn != self._woken_in:
            if self._woken_in is not None:
                self._regather()
            self._woken_in = turn

    def catch_up(self) -> None:
        """Gather again if the executor was woken, and the running thread has waited since."""
        if self._woken_in is not None and self._woken_in != self._clock.turn:
            self._regather()

    def _regather(self) -> None:
        if self.pool is not None:
            self._gathering = next(_gatherings)
            self._groups_left_out.clear()
            self._woken_in = None

    # Tasks

    def add_task(self, task: Task[Any]) -> None:
        """Serve a task in the next cycle."""
        self._tasks.append(task)

    def _ask_again(self) -> None:
        """Where tasks that await are asked again, have each cycle of a pool begin with them.

        So in the queue of the workers they come right behind the snapshot before, whose callbacks have not
        begun: rclpy's ``_wait_for_ready_callbacks`` yields all of ``_tasks`` that do not run, then waits.
        """
        if self._asks_tasks_again and self.pool is not None:
            self.recall_foreign_awaits()
            self._tasks.extend(self.pool.asked_again())

    def recall_foreign_awaits(self) -> None:
        """Resume the tasks that await something unknown, because the executor is woken."""
        self._tasks.extend(self.foreign_awaits)
        self.foreign_awaits.clear()


_STAGES = ("the rest", "what was waited for")
"""The stages that are served before a new gathering."""
