"""Running what has become ready: entering its group, calling it, ending it; and telling why others wait."""

from __future__ import annotations

import inspect
from abc import abstractmethod
from contextlib import AbstractContextManager
from threading import get_ident
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from sim.clock import Clock, Stopped
from sim.ros.entity import Entity, Taken
from sim.ros.probe import Probe
from sim.ros.task import Task
from sim.trace.events import Reason

if TYPE_CHECKING:
    from sim.ros.executors import Executor

Work: TypeAlias = "Entity | Task[Any]"
"""What a cycle yields."""
Begun: TypeAlias = "tuple[Entity, Taken] | Task[Any]"
"""A callback that its group has let in and that has what it needs to run."""
Started: TypeAlias = "tuple[Entity, Taken, int] | Task[Any]"
"""A callback that runs on this thread by its trace, and what ran here before (its id)."""


class RunsWork:
    """The half of an executor that runs callbacks and tasks, and knows which run."""

    threads: int
    _lock: AbstractContextManager[bool]
    _clock: Clock
    _probe: Probe
    _coroutines: dict[Task[Any], Entity]
    _foreign_awaits: list[Task[Any]]
    _waiting: bool
    _spinning: bool
    _is_shutdown: bool
    _running: list[Entity]
    _task_threads: list[int]
    _at_work: int
    _idle_signals: list[Any]

    @abstractmethod
    def wake(self) -> None:
        """Have the executor look again at what is ready."""

    @abstractmethod
    def _wake(self) -> None:
        """As ``wake``, with the lock held."""

    @abstractmethod
    def _look_again(self) -> None:
        """Something may be ready that was not. With the lock held."""

    def _begin(self, work: Work, now: int) -> Begun | None:
        """Enter the group and take what is there; None: refused, or nothing there. With the lock held."""
        if isinstance(work, Task):
            self._at_work += 1
            return work
        taken = self._enter(work, now)
        return None if taken is None else (work, taken)

    def _enter(self, entity: Entity, now: int) -> Taken | None:
        entity.handed_out = False
        if self._is_shutdown or entity.destroyed or not entity.callback_group.beginning_execution(entity):
            self.wake()
            return None
        taken = entity.take(now)
        if taken is None:
            entity.callback_group.ending_execution(entity)
            self.wake()
            return None
        self._running.append(entity)
        self._at_work += 1
        if entity.wait_shown is not None:
            self._probe.wait_ended(entity)
        if entity.pending and entity.callback_group.can_execute(entity):
            self._wake()
        return taken

    def _start(self, begun: Begun) -> Started:
        """Tell the trace that it runs on this thread. With the lock held since it was taken.

        Else what another thread takes next, or what its queue loses, could come before it on the trace.
        """
        if isinstance(begun, Task):
            return begun
        entity, taken = begun
        outer = self._probe.callback_started(entity, taken.message, taken.age, taken.left)
        return entity, taken, outer

    def _run(self, started: Started) -> None:
        """Run what has started on this thread; what it raises is raised."""
        if isinstance(started, Task):
            self._run_task(started)
        else:
            self._run_callback(*started)

    def _run_callback(self, entity: Entity, taken: Taken, outer: int) -> None:
        try:
            outcome = entity.invoke(taken)
        except BaseException as error:
            self._fail(entity, error, outer)
            raise
        if outcome is not None and inspect.iscoroutine(outcome):
            task: Task[Any] = Task(outcome, executor=cast("Executor", self))
            self._coroutines[task] = entity
            self._step(task, entity, outer)
        else:
            self._end(entity, outer)

    def _run_task(self, task: Task[Any]) -> None:
        """Run a task as far as it gets."""
        entity = self._coroutines.get(task)
        if entity is None:
            self._task_threads.append(get_ident())
            try:
                task()
            finally:
                with self._lock:
                    self._task_threads.remove(get_ident())
                    self._leave()
            error = task.exception() if task._settled() else None
            if error is not None:
                raise error
        else:
            with self._lock:
                self._running.append(entity)
                outer = self._probe.callback_resumed(entity)
            self._step(task, entity, outer)

    def _step(self, task: Task[Any], entity: Entity, outer: int) -> None:
        awaited = task._advance()
        if not task._settled():
            with self._lock:
                self._running.remove(entity)
                self._probe.callback_suspended(entity, outer)
            task._arm(awaited)
            with self._lock:
                self._leave()
            return
        del self._coroutines[task]
        error = task.exception()
        if error is not None:
            self._fail(entity, error, outer)
            raise error
        self._end(entity, outer)

    def _fail(self, entity: Entity, error: BaseException, outer: int) -> None:
        if not isinstance(error, (Stopped, KeyboardInterrupt)):
            with self._lock:
                self._probe.callback_failed(entity, error)
        self._end(entity, outer)

    def _end(self, entity: Entity, outer: int) -> None:
        with self._lock:
            self._running.remove(entity)
            self._probe.callback_ended(entity, outer)
            entity.callback_group.ending_execution(entity)
            self._wake_sharers(entity)
            self._leave()

    def _wake_sharers(self, entity: Entity) -> None:
        """The group is free: wake this executor if it waits, and any other that serves its members."""
        if self._waiting or self._foreign_awaits:
            self._look_again()
        for node in entity.callback_group.other_nodes(entity.node):
            executor = node._agenda.executor
            if executor is not None and executor is not self:
                executor.wake()

    def _leave(self) -> None:
        """A thread is done with its work. With the lock held."""
        self._at_work -= 1
        if self._at_work == 0 and self._idle_signals:
            signals, self._idle_signals = self._idle_signals, []
            for signal in signals:
                signal.set()

    def _runs_here(self) -> bool:
        """Whether the calling thread runs a callback or a task of this executor."""
        here = self._probe.callback_here()
        is_callback = here != 0 and any(each.trace_id == here for each in self._running)
        return is_callback or get_ident() in self._task_threads

    def _wait_for_the_running(self, nanoseconds: int) -> bool:
        with self._lock:
            if self._at_work == 0:
                return True
            signal = self._clock.signal()
            self._idle_signals.append(signal)
        return signal.wait(None if nanoseconds < 0 else self._clock.now() + nanoseconds)

    # Telling why something waits; with the host's lock held

    def _explain_wait(self, entity: Entity) -> None:
        """Record why a ready callback of this executor does not run; nothing if it is about to."""
        busy = self._workers_busy()
        if not self._spinning and not entity.handed_out:
            self._probe.waits(entity, Reason.NOBODY_SPINS, None, workers_busy=False)
        elif not entity.callback_group.can_execute(entity):
            self._probe.waits(entity, Reason.GROUP_HELD, self._holder_of(entity), workers_busy=busy)
        elif busy:
            culprit = self._running[0] if self._running else None
            self._probe.waits(entity, Reason.NO_FREE_WORKER, culprit, workers_busy=True)

    def _workers_busy(self) -> bool:
        return self._at_work >= self.threads

    def _holder_of(self, entity: Entity) -> Entity | None:
        holder: Entity | None = getattr(entity.callback_group, "holder", None)
        return holder
