"""The executors of rclpy: one runs callbacks in the thread that spins, one on a pool of workers."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Self

from sim.ros.context import Context
from sim.ros.executor import (
    ConditionReachedException,
    Executor,
    ExternalShutdownException,
    ShutdownException,
    TimeoutException,
    never,
)
from sim.ros.task import Task
from sim.ros.utilities import get_available_threads, get_default_context
from sim.ros.workers import WorkerPool

__all__ = [
    "ConditionReachedException",
    "Executor",
    "ExternalShutdownException",
    "MultiThreadedExecutor",
    "ShutdownException",
    "SingleThreadedExecutor",
    "TimeoutException",
]


class SingleThreadedExecutor(Executor):
    """Runs callbacks one after another in the thread that spins.

    An exception in a callback leaves ``spin`` at once; spinning again goes on.
    """

    def __new__(cls, *, context: Context | None = None) -> Self:
        """Make it; where the run was set up with a number of threads, the kind with that many."""
        chosen = get_default_context() if context is None else context
        if cls is SingleThreadedExecutor and (chosen.host.threads or 1) > 1 and chosen.probe.visible:
            return MultiThreadedExecutor(context=chosen)  # type: ignore[return-value]
        return super().__new__(cls)

    def _spin_once_impl(
        self, timeout_sec: float | None = None, wait_condition: Callable[[], bool] = never
    ) -> None:
        try:
            work = self._await_work(timeout_sec, wait_condition)
        except (ShutdownException, TimeoutException, ConditionReachedException):
            return
        if isinstance(work, Task):
            self._run_task(work)
        else:
            self._handle(work)


class MultiThreadedExecutor(Executor):
    """Runs callbacks on a pool of ``num_threads`` workers; the thread that spins only dispatches.

    None: as many as the CPUs this process may use, else 2. An exception of a callback comes out of ``spin``
    only when a later callback is handed to the pool.
    """

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        chosen = get_default_context() if context is None else context
        override = chosen.host.threads if chosen.probe.visible else None
        self.threads = override or (get_available_threads() if num_threads is None else num_threads)
        if self.threads < 1:
            raise ValueError("max_workers must be greater than 0")
        if self.threads == 1:
            warnings.warn(
                "MultiThreadedExecutor is used with a single thread.\n"
                "Use the SingleThreadedExecutor instead.",
                stacklevel=2,
            )
        super().__init__(context=chosen)
        self._pool = WorkerPool(self)

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Yield nothing more, wait for what runs, and end the workers."""
        done = super().shutdown(timeout_sec)
        self._pool.dismiss()
        return done

    def spin(self) -> None:
        """Run callbacks until the context ends or the executor is shut down.

        Raises:
            RuntimeError: it is already spinning.
        """
        self._pool.dispatches_itself = True
        try:
            super().spin()
        finally:
            self._pool.dispatches_itself = False

    def _spin_once_impl(
        self, timeout_sec: float | None = None, wait_condition: Callable[[], bool] = never
    ) -> None:
        try:
            work = self._await_work(timeout_sec, lambda: wait_condition() or self._pool.error_surfaces)
        except (ExternalShutdownException, ShutdownException, TimeoutException, ConditionReachedException):
            self._pool.raise_surfacing()
            return
        with self._lock:
            self._pool.submit(work)
        self._pool.raise_surfacing()

    def _may_begin_cycle(self) -> bool:
        return self._pool.all_begun()

    def _look_again(self) -> None:
        """Workers look for themselves while ``spin`` runs."""
        if not self._pool.dispatches_itself:
            self.wake()

    def _workers_busy(self) -> bool:
        return self._pool.all_busy()
