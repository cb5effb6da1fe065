"""Runs ready callbacks: enters the group, calls the callback, leaves the group. Explains why others wait."""

from __future__ import annotations

import inspect
import weakref
from collections.abc import Coroutine
from typing import TYPE_CHECKING, Any, TypeAlias

from sim.interpreter.function_marks import calls_the_program
from sim.ros.scheduling.cycle import Cycle, Work
from sim.ros.scheduling.entity import Entity, TakenData
from sim.ros.scheduling.handlers import Handler, awaits, discard
from sim.ros.scheduling.program_task import TaskEntity, program_task
from sim.ros.scheduling.task import Task
from sim.trace.events import Reason

if TYPE_CHECKING:
    from sim.ros.scheduling.executor import Executor

AdmittedWork: TypeAlias = "tuple[Entity, TakenData] | Task[Any]"
"""A callback that its group has admitted, with its data; or a task."""
StartedWork: TypeAlias = "tuple[Entity, TakenData, int] | Task[Any]"
"""A callback that the trace shows as running, with the id of what ran on this thread before; or a task."""


class CallbackRunner:
    """Runs the callbacks and tasks of an executor. Guarded by the host's lock."""

    def __init__(self, executor: Executor) -> None:
        # A weak reference, so that an executor that is dropped without a shutdown is freed at once.
        self._executor = weakref.ref(executor)
        self._host = executor.context.host
        self.lock = self._host.lock
        self.clock = self._host.clock
        self.cycle: Cycle
        """The executor's cycle."""
        self._probe = executor.context.probe
        self._coroutines: dict[Task[Any], Entity] = {}
        self._shown: dict[Task[Any], tuple[TaskEntity, int]] = {}
        """What stands on the trace for tasks that run, and what ran on their threads before."""
        self._running: list[Entity] = []
        self._stopped_at = 0
        self.at_work = 0
        """How many callbacks and tasks have started and not ended."""
        self.refuses = False
        """Whether no callback may start any more."""
        self.asks_groups = True
        """Whether callback groups are used."""
        self.asks_in_next_cycle = True
        """Whether a task that has just started to await is resumed in the next cycle in any case."""

    @property
    def executor(self) -> Executor:
        """The executor, which exists as long as a callback runs."""
        executor = self._executor()
        assert executor is not None
        return executor

    def entity_of(self, task: Task[Any]) -> Entity | None:
        """The entity whose callback a task continues; None for other tasks."""
        return task.entity if isinstance(task, Handler) else self._coroutines.get(task)

    # From group entered to group left

    def begin(self, work: Work, now: int) -> AdmittedWork | None:
        """Enter the group and take the data; None: refused, or no data. Called with the lock held."""
        if isinstance(work, Task):
            self.at_work += 1
            return work
        taken = self.enter(work, now)
        return None if taken is None else (work, taken)

    def enter(self, entity: Entity, now: int) -> TakenData | None:
        """Enter the group of an entity, and take the data; otherwise as ``begin``."""
        entity.handed_out = False
        cycle = self.cycle
        if cycle.pool is not None:
            cycle.entered(entity)
        if self.refuses or entity.destroyed or not entity.callback_group.beginning_execution(entity):
            self.executor.wake()
            return None
        taken = self.take(entity, now)
        if taken is None:
            entity.callback_group.ending_execution(entity)
            self.executor.wake()
            return None
        if entity.pending and entity.callback_group.can_execute(entity):
            self.executor._wake()
        self.executor._callback_changed()
        return taken

    def take(self, entity: Entity, now: int) -> TakenData | None:
        """Take the data for a callback without entering its group; None: there is none."""
        taken = entity.take(now)
        if taken is not None:
            entity.entered_at = now
            self._running.append(entity)
            self.at_work += 1
            if entity.wait_shown is not None:
                self._probe.wait_ended(entity)
        return taken

    def start(self, begun: AdmittedWork) -> StartedWork:
        """Record that the work runs on this thread. Called with the lock held since the data were taken.

        Otherwise the trace could have the next take of another thread, or a drop, before this event.
        """
        if isinstance(begun, Task):
            self._task_started(begun)
            return begun
        entity, taken = begun
        return entity, taken, self._probe.callback_started(entity, taken.message, taken.age, taken.left)

    @calls_the_program
    def run(self, started: StartedWork) -> None:
        """Run started work on this thread, and raise its exception."""
        if isinstance(started, Task):
            self._run_task(started)
        else:
            self._run_callback(*started)

    def _run_callback(self, entity: Entity, taken: TakenData, outer: int) -> None:
        try:
            outcome = entity.invoke(taken)
        except BaseException as error:
            self.fail(entity, error, outer)
            raise
        if outcome is not None and inspect.iscoroutine(outcome):
            self.executor._coroutine_returned(entity, outcome, outer)
        else:
            self.end(entity, outer)

    def drive(self, entity: Entity, coroutine: Coroutine[Any, Any, Any], outer: int) -> None:
        """Run a callback's coroutine up to its next await, if it is awaited; it continues as a task."""
        if awaits(entity):
            self._step(self._task_of(entity, coroutine), entity, outer)
        else:
            self.drop(entity, coroutine, outer)

    def drop(self, entity: Entity, coroutine: Coroutine[Any, Any, Any], outer: int) -> None:
        """A callback has returned a coroutine that nobody awaits, and so has ended."""
        try:
            discard(entity, coroutine)
        except TypeError as error:
            self.fail(entity, error, outer)
            raise
        self.end(entity, outer)

    def postpone(self, entity: Entity, coroutine: Coroutine[Any, Any, Any], outer: int) -> None:
        """Start a callback's coroutine as a task."""
        self.suspend(entity, outer)
        self.executor._resume(self._task_of(entity, coroutine))

    def _task_of(self, entity: Entity, coroutine: Coroutine[Any, Any, Any]) -> Task[Any]:
        task: Task[Any] = Task(coroutine, executor=self.executor)
        task.number = entity.task_number or task.number
        self._coroutines[task] = entity
        return task

    def _run_task(self, task: Task[Any]) -> None:
        """Run a task up to its next await."""
        entity = self._coroutines.get(task)
        if task._waits_still:
            task._arm(task._awaited)
            with self.lock:
                self._leave()
        elif entity is None:
            try:
                task()
            finally:
                with self.lock:
                    self._task_left(task)
                    self._leave()
            error = task.exception() if task._settled() else None
            if error is not None:
                raise error
        else:
            with self.lock:
                self._running.append(entity)
                outer = self._probe.callback_resumed(entity)
            self._step(task, entity, outer)

    def _task_started(self, task: Task[Any]) -> None:
        """Record that a task of the program begins or continues here. Called with the lock held."""
        if task in self._coroutines or task._waits_still or task._settled():
            return
        shown = program_task(task, self.executor.get_nodes)
        if shown is None:
            return
        self._running.append(shown)
        shown.entered_at = self.clock.now()
        probe = self._probe
        was_here = task._was_suspended
        outer = probe.callback_resumed(shown) if was_here else probe.callback_started(shown, 0, 0, 0)
        self._shown[task] = shown, outer

    def _task_left(self, task: Task[Any]) -> None:
        """Record that a task of the program awaits, or has ended. Called with the lock held."""
        shown, outer = self._shown.pop(task, (None, 0))
        if shown is None:
            return
        self._running.remove(shown)
        if not task._settled():
            self._probe.callback_suspended(shown, outer, task._handler)
            return
        if (error := task._exception) is not None:
            self._probe.callback_failed(shown, error)
        self._probe.callback_ended(shown, outer)

    def go_on(self, task: Task[Any]) -> None:
        """Continue a task on this thread, inside another task, which does not raise its exception."""
        with self.lock:
            self.at_work += 1
            self._task_started(task)
        try:
            self._run_task(task)
        except Exception as error:  # noqa: BLE001 -- kept for the spinning thread, or lost
            self.executor._failed_after_await(task, error)

    def _step(self, task: Task[Any], entity: Entity, outer: int) -> None:
        awaited = task._advance()
        if not task._settled():
            with self.lock:
                self._stop(entity)
                self._probe.callback_suspended(entity, outer, task._handler)
            try:
                task._arm(awaited)
            finally:
                with self.lock:
                    self._leave()
            return
        del self._coroutines[task]
        error = task.exception()
        if error is not None:
            self.fail(entity, error, outer)
            raise error
        self.end(entity, outer)

    def fail(self, entity: Entity, error: BaseException, outer: int) -> None:
        """A callback has raised an exception, and so has ended."""
        if not isinstance(error, KeyboardInterrupt):
            with self.lock:
                self._probe.callback_failed(entity, error)
        self.end(entity, outer)

    def end(self, entity: Entity, outer: int) -> None:
        """A callback has ended: leave its group, and wake its executor.

        As in rclpy, another executor that serves members of the group is not woken.
        """
        with self.lock:
            self._stop(entity)
            self._probe.callback_ended(entity, outer)
            if self.asks_groups and not entity.stuck:
                self._free_group_of(entity)
            self._leave()

    def _free_group_of(self, entity: Entity) -> None:
        cycle = self.cycle
        if cycle.pool is not None:
            cycle.leaving(entity)
        entity.callback_group.ending_execution(entity)
        executor = self._executor()
        if executor is not None:
            executor._callback_changed()
            if executor._waiting:
                executor._recheck()

    def suspend(self, entity: Entity, outer: int, coroutine: object = None) -> None:
        """A coroutine callback awaits something and leaves this thread."""
        with self.lock:
            self._stop(entity)
            self._probe.callback_suspended(entity, outer, coroutine)
            self._leave()

    def resume(self, entity: Entity) -> int:
        """A coroutine callback continues on this thread; return the id of what ran here before."""
        with self.lock:
            self._running.append(entity)
            self.at_work += 1
            return self._probe.callback_resumed(entity)

    def _stop(self, entity: Entity) -> None:
        """A callback is about to leave its thread, for which others may wait. Called with the lock held."""
        self._host.catch_up()
        self._running.remove(entity)
        self._stopped_at = self.clock.now()

    def _leave(self) -> None:
        """A thread has finished its work. Called with the lock held."""
        self.at_work -= 1

    # Callbacks that run inside a task

    def show(self, entity: Entity) -> None:
        """An entity's callback runs on this thread, inside a task."""
        with self.lock:
            self._running.append(entity)

    def hide(self, entity: Entity) -> None:
        """The entity's callback no longer runs on this thread."""
        with self.lock:
            self._running.remove(entity)

    # Questions

    def explain_wait(self, entity: Entity) -> None:
        """Record why a ready callback of this executor waits; record nothing if it is about to run."""
        executor, tell, now = self.executor, self._probe.waits, self.clock.now()
        busy, first = executor._workers_busy(), self._running[0] if self._running else None
        if not executor._spinning and not entity.handed_out:
            tell(entity, Reason.NOBODY_SPINS, None, busy=False, began=now)
        elif not self.asks_groups:
            if busy:
                tell(entity, Reason.EVENT_QUEUE, first, busy=True, began=self._busy_since())
        elif not entity.callback_group.can_execute(entity):
            holder: Entity | None = getattr(entity.callback_group, "holder", None)
            tell(entity, Reason.GROUP_HELD, holder, busy, now if holder is None else holder.entered_at)
        elif busy:
            tell(entity, Reason.NO_FREE_WORKER, first, busy=True, began=self._busy_since())
        elif entity.wait_shown is not None:  # another executor freed the group without waking this one
            self._probe.wait_ended(entity)

    def _busy_since(self) -> int:
        """Since when the same callbacks run."""
        return max([self._stopped_at, *(each.entered_at for each in self._running)])
