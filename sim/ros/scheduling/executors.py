"""The executors of rclpy: one runs callbacks in the spinning thread, the other on a pool of workers."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from typing import Any, Self

from sim.ros.context.context import Context
from sim.ros.context.utilities import get_available_threads, get_default_context
from sim.ros.scheduling.cycle import Work
from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.executor import Executor
from sim.ros.scheduling.racing import RacingCycle, RacingPool
from sim.ros.scheduling.running import StartedWork
from sim.ros.scheduling.task import Future, Task
from sim.ros.scheduling.waiting_ends import (
    ConditionReachedException,
    ExternalShutdownException,
    ShutdownException,
    Timeout,
    TimeoutException,
    TimeoutObject,
    never,
)
from sim.ros.scheduling.workers import WorkerPool

__all__ = [
    "ConditionReachedException",
    "Executor",
    "ExternalShutdownException",
    "MultiThreadedExecutor",
    "ShutdownException",
    "SingleThreadedExecutor",
    "TimeoutException",
    "TimeoutObject",
    "await_or_execute",
]


async def await_or_execute(callback: Callable[..., Any], *args: Any) -> Any:
    """Call a function, or call and await a coroutine function; return the result."""
    if inspect.iscoroutinefunction(callback):
        return await callback(*args)
    return callback(*args)


class SingleThreadedExecutor(Executor):
    """Runs callbacks one after another in the spinning thread.

    ``spin`` raises an exception of a callback at once; it can be called again.
    """

    def __new__(cls, *, context: Context | None = None) -> Self:
        """Create the executor; a MultiThreadedExecutor if the run overrides the number of threads."""
        chosen = get_default_context() if context is None else context
        if cls is SingleThreadedExecutor and (chosen.host.threads or 1) > 1 and chosen.probe.visible:
            return MultiThreadedExecutor(context=chosen)  # type: ignore[return-value]
        return super().__new__(cls)

    def _spin_once_impl(
        self, timeout_sec: Timeout = None, wait_condition: Callable[[], bool] = never
    ) -> None:
        self._set_wanted(timeout_sec, None, wait_condition)
        try:
            started = self._await_work(timeout_sec, wait_condition, self._begin_and_start)
        except (ShutdownException, TimeoutException, ConditionReachedException):
            return
        if started is not None:
            self._runner.run(started)

    def _begin_and_start(self, work: Work, now: int) -> StartedWork | None:
        begun = self._runner.begin(work, now)
        return None if begun is None else self._runner.start(begun)


class MultiThreadedExecutor(Executor):
    """Runs callbacks on a pool of ``num_threads`` workers; the spinning thread only dispatches them.

    None: the number of CPUs that this process may use, or 2. ``spin`` raises an exception of a callback
    only when a later callback is handed to the pool.
    """

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        chosen = get_default_context() if context is None else context
        override = chosen.host.threads if chosen.probe.visible else None
        self.threads = override or (get_available_threads() if num_threads is None else num_threads)
        if self.threads < 1:
            raise ValueError("max_workers must be greater than 0")
        if self.threads == 1 and chosen.host.profile.warns_of_one_thread:
            warnings.warn(
                "MultiThreadedExecutor is used with a single thread.\n"
                "Use the SingleThreadedExecutor instead.",
                stacklevel=2,
            )
        races = chosen.host.clock.races()
        if races:
            self._cycle_type = RacingCycle
        super().__init__(context=chosen)
        self._pool = RacingPool(self) if races else WorkerPool(self)
        self._cycle.pool = self._pool
        self._spinning_on = False

    @property
    def _executor(self) -> WorkerPool:
        """The pool, by rclpy's name."""
        return self._pool

    def shutdown(self, timeout_sec: float | None = None, *, wait_for_threads: bool | None = None) -> bool:
        """Stop yielding work; in some releases also wait until the workers end, unless told not to.

        Raises:
            TypeError: the release does not have ``wait_for_threads``.
        """
        ends_workers = self._profile.ends_workers
        if wait_for_threads is not None and not ends_workers:
            raise TypeError("Executor.shutdown() got an unexpected keyword argument 'wait_for_threads'")
        done = super().shutdown(timeout_sec)
        if ends_workers:
            self._pool.dismiss()
            if wait_for_threads is not False:
                self._pool.wait_for_end()
        return done

    def spin(self) -> None:
        """Run callbacks until the context ends or the executor is shut down.

        Raises:
            RuntimeError: it is already spinning.
        """
        with self._spin_on():
            super().spin()

    def spin_until_future_complete(self, future: Future[Any], timeout_sec: float | None = None) -> None:
        """Run callbacks until the future is done, for at most ``timeout_sec`` seconds."""
        with self._spin_on(until=future._settled):
            super().spin_until_future_complete(future, timeout_sec)

    @contextmanager
    def _spin_on(self, until: Callable[[], bool] = never) -> Generator[None, None, None]:
        """In this context workers may find their next callback themselves, ``until`` a condition holds."""
        outer = self._spinning_on, self._pool.should_stop
        self._set_spinning_on(True, until)
        try:
            yield
        finally:
            self._set_spinning_on(*outer)

    def _set_spinning_on(self, spinning_on: bool, enough: Callable[[], bool]) -> None:
        with self._lock:
            self._spinning_on = spinning_on
            self._pool.should_stop = enough
            if not isinstance(self._pool, RacingPool):  # rclpy's spin() wakes nobody
                self._waitables_changed()

    def _waitables_changed(self) -> None:
        """Let workers find callbacks unless waitables must be polled, which only the spinning thread does."""
        super()._waitables_changed()
        self._pool.dispatches_itself = self._spinning_on and not self._polls_waitables

    def _spin_once_impl(
        self, timeout_sec: Timeout = None, wait_condition: Callable[[], bool] = never
    ) -> None:
        self._set_wanted(timeout_sec, None, wait_condition)
        with suppress(
            ExternalShutdownException, ShutdownException, TimeoutException, ConditionReachedException
        ):
            self._await_work(
                timeout_sec, lambda: wait_condition() or self._pool.error_surfaces, self._pool.submit
            )
            self._pool.await_start()
        self._pool.raise_surfacing()

    def _entity_ready(self, entity: Entity) -> None:
        self._cycle.catch_up()
        super()._entity_ready(entity)

    def _wake(self) -> None:
        self._cycle.woken()
        super()._wake()

    def _work_arrived(self) -> None:
        """Call an idle worker, which finds the work without the spinning thread."""
        if not self._pool.worker_looks():
            super()._work_arrived()

    def _recheck(self) -> None:
        """Wake the executor, unless workers find their callbacks themselves."""
        if not self._pool.dispatches_itself:
            self._wake()

    def _failed_after_await(self, _task: Task[Any], error: Exception) -> None:
        with self._lock:
            self._pool.keep(error)

    def _workers_busy(self) -> bool:
        return self._pool.all_busy()
