"""What all executors share: waiting until something is ready, running it, and telling why others wait.

The order is decided by the wait set, the exclusion by the callback groups; the kinds of executor add the
threads. Whoever changes what is ready wakes the executor if it waits.
"""

from __future__ import annotations

import inspect
from collections import deque
from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeAlias

from sim.clock import Stopped
from sim.ros.context import Context
from sim.ros.entity import Entity, Taken
from sim.ros.task import Future, Task
from sim.ros.utilities import get_default_context, timeout_sec_to_nsec
from sim.ros.wait_set import WaitSet
from sim.trace.events import Reason

if TYPE_CHECKING:
    from sim.ros.node import Node
    from sim.ros.timer import Timer

Work: TypeAlias = "Entity | Task[Any]"


class ExternalShutdownException(Exception):
    """The context ended while its executor was spinning."""


class ShutdownException(Exception):
    """The executor was shut down while something waited for its work."""


class TimeoutException(Exception):
    """Nothing became ready in time."""


class ConditionReachedException(Exception):
    """The condition that ends the waiting holds."""


def never() -> bool:
    """The condition that ends no waiting."""
    return False


class Executor:
    """Base of all executors; a program may write its own kind by ``_spin_once_impl``."""

    threads = 1
    """How many callbacks can run at once."""

    def __init__(self, *, context: Context | None = None) -> None:
        self._context = get_default_context() if context is None else context
        self._host = self._context.host
        self._lock = self._host.lock
        self._clock = self._host.clock
        self._probe = self._context.probe
        self._nodes: list[Node] = []
        self._wait_set = WaitSet()
        self._tasks: deque[Task[Any]] = deque()
        self._due_tasks: deque[Task[Any]] = deque()
        self._looked = True
        self._foreign_awaits: list[Task[Any]] = []
        self._coroutines: dict[Task[Any], Entity] = {}
        self._signal = self._clock.signal()
        self._waits_until: int | None = None
        self._waiting = False
        self._spinning = False
        self._is_shutdown = False
        self._running: list[Entity] = []
        self._at_work = 0
        self._idle_signals: list[Any] = []
        self._context.on_shutdown(self.wake)
        self._probe.executor_made(type(self).__name__, self.threads)

    # Public

    @property
    def context(self) -> Context:
        """The context it lives in."""
        return self._context

    def add_node(self, node: Node) -> bool:
        """Serve a node from now on, and let its former executor go; whether it was not served already."""
        with self._lock:
            if node in self._nodes:
                return False
            self._nodes.append(node)
            node.executor = self
            self.wake()
            return True

    def remove_node(self, node: Node) -> None:
        """Serve a node no more."""
        with self._lock:
            if node in self._nodes:
                self._nodes.remove(node)
                node.executor = None
                self.wake()

    def get_nodes(self) -> list[Node]:
        """The nodes it serves."""
        return list(self._nodes)

    def wake(self) -> None:
        """Have it look again at what is ready."""
        with self._lock:
            if self._foreign_awaits:
                self._tasks.extend(self._foreign_awaits)
                self._foreign_awaits.clear()
            if self._waiting:
                self._signal.set()

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Task[Any]:
        """Run a function or coroutine soon, before whatever else is ready."""
        task: Task[Any] = Task(callback, args, kwargs, executor=self)
        self._resume(task)
        return task

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Yield nothing more and wait for what runs; False if ``timeout_sec`` seconds were not enough."""
        with self._lock:
            self._is_shutdown = True
            self.wake()
        if not self._wait_for_the_running(timeout_sec_to_nsec(timeout_sec)):
            return False
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
            future._set_executor(self)
            future.add_done_callback(lambda _: self.wake())
            nanoseconds = timeout_sec_to_nsec(timeout_sec)
            end = None if nanoseconds < 0 else self._clock.now() + nanoseconds
            while self._context.ok() and not future.done() and not self._is_shutdown:
                left = None if end is None else max(end - self._clock.now(), 0) / 1e9
                self._spin_once_impl(left, future.done)
                if end is not None and self._clock.now() >= end:
                    return

    def spin_once_until_future_complete(self, future: Future[Any], timeout_sec: float | None = None) -> None:
        """Run one callback, unless the future is done first."""
        with self._enter_spin():
            future._set_executor(self)
            future.add_done_callback(lambda _: self.wake())
            self._spin_once_impl(timeout_sec, future.done)

    # Waiting for work

    def _spin_once_impl(
        self, timeout_sec: float | None = None, wait_condition: Callable[[], bool] = never
    ) -> None:
        raise NotImplementedError

    @contextmanager
    def _enter_spin(self) -> Generator[None, None, None]:
        with self._lock:
            if self._spinning:
                raise RuntimeError("Executor is already spinning")
            self._spinning = True
        try:
            yield
        finally:
            self._spinning = False

    def _await_work(self, timeout_sec: float | None, condition: Callable[[], bool]) -> Work:
        """Wait for the next thing to run, marked as handed out.

        Raises:
            ExternalShutdownException, ShutdownException, TimeoutException, ConditionReachedException:
                there is none for that reason.
        """
        nanoseconds = timeout_sec_to_nsec(timeout_sec)
        deadline = None if nanoseconds < 0 else self._clock.now() + nanoseconds
        while True:
            with self._lock:
                self._waiting = False
                if not self._context.ok():
                    raise ExternalShutdownException
                if self._is_shutdown:
                    raise ShutdownException
                if condition():
                    raise ConditionReachedException
                now = self._clock.now()
                work = self._next_work(now)
                if work is not None:
                    return work
                if deadline is not None and now >= deadline:
                    raise TimeoutException
                until = _earliest((deadline, *(node._agenda.next_due() for node in self._nodes)))
                self._waits_until = until
                self._waiting = True
            self._signal.wait(until)

    def _next_work(self, now: int) -> Work | None:
        """Yield the next of this cycle, of a new one once it is served to its end. With the lock held."""
        work = self._next_of_cycle(now)
        if work is None and self._may_begin_cycle():
            self._due_tasks, self._tasks = self._tasks, self._due_tasks
            self._looked = False
            work = self._next_of_cycle(now)
        return work

    def _next_of_cycle(self, now: int) -> Work | None:
        if self._due_tasks:
            return self._due_tasks.popleft()
        if not self._looked:
            self._looked = True
            for node in self._nodes:
                if node._agenda.warnings:
                    node._agenda.speak_warnings()
            self._wait_set.look(self._nodes, now)
        return self._wait_set.next(now)

    def _may_begin_cycle(self) -> bool:
        return True

    # Being told; with the host's lock held

    def _entity_ready(self, entity: Entity) -> None:
        if self._waiting and not entity.handed_out and entity.callback_group.can_execute(entity):
            self._signal.set()

    def _timer_set(self, timer: Timer) -> None:
        if timer.due <= self._clock.now():
            self._entity_ready(timer)
        elif self._waiting and (self._waits_until is None or timer.due < self._waits_until):
            self._signal.set()

    def _look_again(self) -> None:
        """Something may be ready that was not; whoever calls this does not look for it."""
        self.wake()

    def _resume(self, task: Task[Any]) -> None:
        with self._lock:
            self._tasks.append(task)
            self.wake()

    def _resume_at_wake_up(self, task: Task[Any]) -> None:
        with self._lock:
            self._foreign_awaits.append(task)

    # Running

    def _begin(self, entity: Entity) -> Taken | None:
        """Enter the group and take what is there; None: refused, or nothing there. With the lock held."""
        entity.handed_out = False
        if self._is_shutdown or entity.destroyed or not entity.callback_group.beginning_execution(entity):
            self.wake()
            return None
        taken = entity.take(self._clock.now())
        if taken is None:
            entity.callback_group.ending_execution(entity)
            self.wake()
            return None
        self._running.append(entity)
        self._at_work += 1
        if entity.wait_shown is not None:
            self._probe.wait_ended(entity)
        if entity.pending and entity.callback_group.can_execute(entity):
            self.wake()
        return taken

    def _run(self, entity: Entity, taken: Taken) -> None:
        """Run a callback that has begun, on this thread; what it raises is raised."""
        outer = self._probe.callback_started(entity, taken.message, taken.age, taken.left)
        try:
            outcome = entity.invoke(taken)
        except BaseException as error:
            self._fail(entity, error, outer)
            raise
        if inspect.iscoroutine(outcome):
            task: Task[Any] = Task(outcome, executor=self)
            self._coroutines[task] = entity
            self._step(task, entity, outer)
        else:
            self._end(entity, outer)

    def _run_task(self, task: Task[Any]) -> None:
        """Run a task as far as it gets; what it raises is raised."""
        entity = self._coroutines.get(task)
        if entity is None:
            with self._lock:
                self._at_work += 1
            try:
                task()
            finally:
                with self._lock:
                    self._leave()
            error = task.exception() if task.done() else None
            if error is not None:
                raise error
        else:
            with self._lock:
                self._running.append(entity)
                self._at_work += 1
            self._step(task, entity, self._probe.callback_resumed(entity))

    def _step(self, task: Task[Any], entity: Entity, outer: int) -> None:
        awaited = task._advance()
        if not task.done():
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
            executor = node.executor
            if executor is not None and executor is not self:
                executor.wake()

    def _leave(self) -> None:
        """A thread is done with its work. With the lock held."""
        self._at_work -= 1
        if self._at_work == 0 and self._idle_signals:
            signals, self._idle_signals = self._idle_signals, []
            for signal in signals:
                signal.set()

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

    # For executors written by a program

    def wait_for_ready_callbacks(
        self,
        timeout_sec: float | None = None,
        nodes: Iterable[Node] | None = None,
        condition: Callable[[], bool] = never,
    ) -> tuple[Task[Any], Entity | None, Node | None]:
        """Wait for the next callback: a task that runs it when called, its entity and its node.

        Raises:
            ExternalShutdownException, ShutdownException, TimeoutException, ConditionReachedException:
                there is none for that reason.
            NotImplementedError: for a choice of nodes.
        """
        if nodes is not None:
            raise NotImplementedError("wait_for_ready_callbacks(nodes=...) is not supported")
        work = self._await_work(timeout_sec, condition)
        if isinstance(work, Task):
            entity = self._coroutines.get(work)
            return work, entity, None if entity is None else entity.node
        return Task(self._handle, (work,), executor=self), work, work.node

    def _handle(self, entity: Entity) -> None:
        with self._lock:
            taken = self._begin(entity)
        if taken is not None:
            self._run(entity, taken)

    def __enter__(self) -> Executor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.shutdown()


def _earliest(times: Iterable[int | None]) -> int | None:
    return min((time for time in times if time is not None), default=None)
