"""The base of all executors: waits until something is ready, and runs it.

The wait set decides the order, and the callback groups decide what may overlap; the kinds of executor add the
threads. Code that makes something ready wakes a waiting executor.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Coroutine, Generator, Iterable
from contextlib import contextmanager
from typing import Any, TypeVar

from sim.ros.context.context import Context
from sim.ros.context.utilities import get_default_context, timeout_sec_to_nsec
from sim.ros.scheduling.cycle import Cycle, Work
from sim.ros.scheduling.entity import Entity, OwnerNode
from sim.ros.scheduling.handlers import Handler
from sim.ros.scheduling.running import CallbackRunner
from sim.ros.scheduling.task import Future, Task
from sim.ros.scheduling.waitable_entity import WaitableEntity, poll_waitables
from sim.ros.scheduling.waiting_ends import (
    ConditionReachedException,
    ExternalShutdownException,
    ShutdownException,
    Timeout,
    TimeoutException,
    TimeoutObject,
    never,
    seconds_of,
)

FoundT = TypeVar("FoundT")


class Executor:
    """Base of all executors. A program may write a subclass with ``_spin_once_impl`` or ``spin_once``."""

    threads = 1
    """How many callbacks can run at the same time."""
    _registered: Collection[Entity] = ()  # kept in use until the next update, though destroyed before
    already_spinning = "Executor is already spinning"
    """The message of the RuntimeError for a nested or second spin."""
    _cycle_type: type[Cycle] = Cycle
    replies_in_tasks = False  # whether a task of its own sends what a service's coroutine returns

    def __init__(self, *, context: Context | None = None) -> None:
        self._context = get_default_context() if context is None else context
        self._context.require_initialized("failed to create guard_condition")
        self._host = self._context.host
        self._lock = self._host.lock
        self._clock = self._host.clock
        self._profile = self._host.profile
        self._probe = self._context.probe
        self._nodes: list[OwnerNode] = []
        self._runner = CallbackRunner(self)
        chosen = None if type(self).can_execute is Executor.can_execute else self.can_execute
        self._cycle = self._runner.cycle = self._cycle_type(
            self._nodes, self._clock, self._runner.entity_of, chosen, self._profile
        )
        self._signal = self._clock.auto_reset_event()
        self._polls_waitables = False
        self._waitables_due: int | None = None
        self._waits_until: int | None = None
        self._waiting = self._spinning = self._is_shutdown = False
        self._context.wake_at_end(self.wake)
        self.trace_id = self._probe.executor_made(type(self).__name__, self.threads)

    @property
    def context(self) -> Context:
        """The executor's context."""
        return self._context

    def add_node(self, node: OwnerNode) -> bool:
        """Serve a node, in place of its former executor; False if this executor serves it already."""
        with self._lock:
            if node in self._nodes:
                return False
            self._nodes.append(node)
            former = node._agenda.executor
            if former is not None and former is not self and former._spinning:
                self._probe.spin_clashed(node.trace_id)
            node.executor = self
            node._agenda.executor = self
            self._waitables_changed()
            return True

    def remove_node(self, node: OwnerNode) -> None:
        """Stop serving a node."""
        with self._lock:
            if node in self._nodes:
                self._nodes.remove(node)
                if node._agenda.executor is self:
                    node._agenda.executor = None
                self._waitables_changed()

    def get_nodes(self) -> list[OwnerNode]:
        """The nodes that this executor serves."""
        return list(self._nodes)

    def wake(self) -> None:
        """Make the executor check again what is ready. Thread-safe."""
        with self._lock:
            self._wake()

    def create_future(self) -> Future[Any]:
        """Create a future whose done-callbacks run as tasks of this executor."""
        return Future(executor=self)

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Task[Any]:
        """Run a function or coroutine in the next cycle, before other ready work."""
        task: Task[Any] = Task(callback, args, kwargs, executor=self)
        self._resume(task)
        return task

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop yielding work; return True.

        As in rclpy, running callbacks are not waited for; ``timeout_sec`` is ignored.
        """
        with self._lock:
            self._is_shutdown = self._runner.refuses = True
            self.wake()
        for node in self.get_nodes():
            self.remove_node(node)
        return True

    def spin(self) -> None:
        """Run callbacks until the context ends or the executor is shut down.

        Raises:
            RuntimeError: it is already spinning.
            ExternalShutdownException: the context ended (single-threaded only).
        """
        with self._enter_spin():
            while self._context.ok() and not self._is_shutdown:
                self._spin_once_impl()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run one callback; wait at most ``timeout_sec`` seconds for it (None or negative: for ever)."""
        with self._enter_spin():
            self._spin_once_impl(timeout_sec)

    def spin_until_future_complete(self, future: Future[Any], timeout_sec: float | None = None) -> None:
        """Run callbacks until the future is done, for at most ``timeout_sec`` seconds."""
        with self._enter_spin():
            self._wake_by(future)
            nanoseconds = timeout_sec_to_nsec(timeout_sec)
            if nanoseconds < 0:
                while self._context.ok() and not future._settled() and not self._is_shutdown:
                    self._spin_for(future, timeout_sec)
                return
            end = self._clock.now() + nanoseconds
            left = TimeoutObject(nanoseconds / 1e9)
            while self._context.ok() and not future._settled() and not self._is_shutdown:
                self._spin_for(future, left)
                now = self._clock.now()
                if now >= end:
                    return
                left.timeout = (end - now) / 1e9

    def spin_once_until_future_complete(self, future: Future[Any], timeout_sec: float | None = None) -> None:
        """Run one callback, unless the future is done before."""
        with self._enter_spin():
            self._wake_by(future)
            self._spin_once_impl(timeout_sec, future._settled)

    def _spin_for(self, future: Future[Any], timeout_sec: Timeout) -> None:
        if not self._profile.wakes_once_for_a_future:
            self._wake_by(future)
        self._spin_once_impl(timeout_sec, future._settled)

    def _wake_by(self, future: Future[Any]) -> None:
        future.add_done_callback(lambda _: self.wake())

    # Waiting for work

    def _spin_once_impl(
        self, timeout_sec: Timeout = None, wait_condition: Callable[[], bool] = never
    ) -> None:
        if type(self).spin_once is Executor.spin_once:
            raise NotImplementedError
        # Programs written for Humble override this method.
        self.spin_once(seconds_of(timeout_sec))

    @contextmanager
    def _enter_spin(self) -> Generator[None, None, None]:
        with self._lock:
            if outer := self._spinning:
                refused = self._refuses_second_spin()
                self._probe.spin_clashed(refused=refused)
                if refused:
                    raise RuntimeError(self.already_spinning)
            self._spinning = True
            self._context.warn_of_unused_parameters()
        try:
            with self._context.process.spin():
                yield
        finally:
            self._spinning = outer

    def _refuses_second_spin(self) -> bool:
        return self._profile.refuses_second_spin

    def _set_wanted(
        self, timeout_sec: Timeout, nodes: Iterable[OwnerNode] | None, condition: Callable[[], bool]
    ) -> None:
        """Set the present wait; if it differs from the last one, the rest of the snapshot is dropped."""
        if (wanted := (timeout_sec, nodes, condition)) != self._cycle.wanted:
            with self._lock:
                self._cycle.set_wanted(wanted, nodes)
                self._wake()
        elif self._waiting:  # another thread waits, in a release that allows a second spin
            raise ValueError("generator already executing")

    def _await_work(
        self, timeout_sec: Timeout, condition: Callable[[], bool], on_found: Callable[[Work, int], FoundT]
    ) -> FoundT:
        """Wait for the next work, mark it as handed out, and return the result of ``on_found``.

        ``on_found`` gets the work and the time, and is called with the lock held.

        Raises:
            ExternalShutdownException, ShutdownException, TimeoutException, ConditionReachedException:
                there is no work, for that reason.
        """
        nanoseconds = -1 if timeout_sec is None else timeout_sec_to_nsec(seconds_of(timeout_sec))
        deadline = None if nanoseconds < 0 else self._clock.now() + nanoseconds
        if nanoseconds == 0:
            self._clock.poll()
        elif nanoseconds > 0:
            self._context.require_ok("failed to create timer")
        while True:
            asked = self._polls_waitables and self._cycle.about_to_look and self._poll_waitables()
            with self._lock:
                self._waiting = False
                now = self._clock.now()
                self._raise_if_over(condition)
                if nanoseconds == 0 and self._cycle.snapshot_ended(now):
                    raise TimeoutException
                work = self._cycle.next(now)
                if work is not None:
                    return on_found(work, now)
                if deadline is not None and now >= deadline and self._cycle.waits:
                    self._wake()
                    self._cycle.stop_waiting()
                    raise TimeoutException
                if self._polls_waitables and not asked and self._cycle.about_to_look:
                    continue
                dues = (node._agenda.next_due() for node in self._cycle.view)
                known = [due for due in (deadline, self._waitables_due, *dues) if due is not None]
                until = self._waits_until = min(known, default=None) if self._cycle.waits else None
                self._waiting = True
            if self._context.ok() and not self._signal.wait(until):  # a signal may just have ended it
                with self._lock:
                    self._cycle.catch_up()

    def _raise_if_over(self, condition: Callable[[], bool]) -> None:
        """Raise the exception that ends the wait, if it is over. Called with the lock held."""
        if self._is_shutdown:
            over: type[Exception] = ShutdownException
        elif not self._context.ok():
            over = ExternalShutdownException
        elif condition():
            over = ConditionReachedException
        else:
            return
        self._cycle.stop_waiting()
        raise over

    def _poll_waitables(self) -> bool:
        """Poll a program's waitables for a cycle that is about to begin; return True."""
        with self._lock:
            # What becomes ready during the poll has to end the wait that may follow.
            self._waiting, self._waits_until = True, None
        self._waitables_due = poll_waitables(self, tuple(self._cycle.view))
        return True

    def _waitables_changed(self) -> None:
        """Nodes or a program's waitables were added or removed. Called with the lock held."""
        self._polls_waitables = any(node._agenda.polled for node in self._nodes)
        self._waitables_due = None
        self.wake()

    # Notifications, with the host's lock held

    def _entity_ready(self, entity: Entity) -> None:
        if self._waiting and not entity.handed_out and entity.callback_group.can_execute(entity):
            self._work_arrived()

    def _entity_has_more(self, entity: Entity) -> None:
        """Another item arrived for an entity that is ready already."""

    def _timer_set(self, timer: Entity) -> None:
        if not self._waiting:
            return
        if timer.due <= self._clock.now():
            self._entity_ready(timer)
        elif self._waits_until is None or timer.due < self._waits_until:
            self._signal.set()

    def _expiry_set(self, _clock: Any) -> None:
        """An action server has set the timer for dropping goals."""

    def _wake(self) -> None:
        self._cycle.recall_foreign_awaits()
        self._wake_spinner()

    def _work_arrived(self) -> None:
        """Work has arrived while the spinning thread waits."""
        self._signal.set()

    def _wake_spinner(self) -> None:
        """Wake the spinning thread if it waits."""
        if self._waiting:
            self._signal.set()

    def _callback_changed(self) -> None:
        """A callback has started or ended: resume the tasks that await something unknown."""
        if self._cycle.foreign_awaits:
            self._recall_awaiting()

    def _recall_awaiting(self) -> None:
        self._cycle.recall_foreign_awaits()
        if self._waiting:
            self._work_arrived()

    def _recheck(self) -> None:
        """A group was freed: an entity may be ready that the caller does not look for."""
        self._wake()

    def _resume(self, task: Task[Any]) -> None:
        with self._lock:
            self._cycle.add_task(task)
            self._recall_awaiting()

    def _resume_at_wake_up(self, task: Task[Any]) -> None:
        with self._lock:
            if task not in self._cycle.foreign_awaits:
                self._cycle.foreign_awaits.append(task)

    def _coroutine_returned(self, entity: Entity, coroutine: Coroutine[Any, Any, Any], outer: int) -> None:
        """A callback has returned a coroutine; ``outer`` ran on its thread before."""
        self._runner.drive(entity, coroutine, outer)

    def _failed_after_await(self, task: Task[Any], _error: Exception) -> None:
        """A coroutine raised after an await: only a reader of the task's exception gets the error."""
        task._exception_fetched = False

    def _workers_busy(self) -> bool:
        return self._runner.at_work >= self.threads

    # For executors written by a program

    def can_execute(self, entity: Entity) -> bool:
        """Whether the executor waits for an entity: it is not handed out, and its group would admit it.

        A subclass may leave more entities out of a cycle. Called with the host's lock held.
        """
        return not entity.handed_out and entity.callback_group.can_execute(entity)

    def wait_for_ready_callbacks(
        self,
        timeout_sec: Timeout = None,
        nodes: Iterable[OwnerNode] | None = None,
        condition: Callable[[], bool] = never,
    ) -> tuple[Task[Any], Any, OwnerNode | None]:
        """Wait for the next callback of ``nodes`` (None: all); return a task for it, its entity and its node.

        For a task of ``create_task`` entity and node are None.

        Raises:
            ExternalShutdownException, ShutdownException, TimeoutException, ConditionReachedException:
                there is no work, for that reason.
            NotImplementedError: one of ``nodes`` was not added.
        """
        self._set_wanted(timeout_sec, nodes, condition)
        work = self._await_work(timeout_sec, condition, lambda work, _now: work)
        task = work if isinstance(work, Task) else Handler(work, self)
        entity = self._runner.entity_of(task)
        if entity is None:
            return task, None, None
        return task, entity.waitable if isinstance(entity, WaitableEntity) else entity, entity.node

    def _wait_for_ready_callbacks(
        self,
        timeout_sec: Timeout = None,
        nodes: Iterable[OwnerNode] | None = None,
        condition: Callable[[], bool] = never,
    ) -> Generator[tuple[Task[Any], Any, OwnerNode | None], None, None]:
        """Yield the results of ``wait_for_ready_callbacks``."""
        while True:
            yield self.wait_for_ready_callbacks(timeout_sec, nodes, condition)

    def __enter__(self) -> Executor:
        return self

    def __exit__(self, *_error: object) -> None:
        self.shutdown()
