"""The worker threads of a MultiThreadedExecutor, and the queue of callbacks that wait for one.

A callback handed to a free worker begins at once; the others wait in the queue, already handed out, in the
order in which they were yielded. The worker that has been idle longest is asked first, and a new one starts
only when none is idle. A worker that ends a callback looks for the next one itself, so that a busy executor
needs no hand-over between threads.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from sim.clock import Signal
from sim.ros.entity import Entity, Taken
from sim.ros.task import Task

if TYPE_CHECKING:
    from sim.ros.executors import MultiThreadedExecutor, Work


class Worker:
    """A thread of the pool; ``job`` is what it runs next."""

    __slots__ = ("job", "signal")

    def __init__(self, signal: Signal) -> None:
        self.signal = signal
        self.job: tuple[Entity, Taken] | Task[Any] | None = None


class WorkerPool:
    """At most ``executor.threads`` workers, started when needed. Its state is guarded by the host's lock."""

    def __init__(self, executor: MultiThreadedExecutor) -> None:
        self.dispatches_itself = False
        """Whether workers may look for their next callback: while ``spin`` runs."""
        self.error_surfaces = False
        """Whether a callback's exception is due to come out of ``spin``."""
        self._executor = executor
        self._lock = executor._lock
        self._clock = executor._clock
        self._name = f"ThreadPoolExecutor-{next(executor._host.pool_numbers)}"
        self._workers: list[Worker] = []
        self._idle: deque[Worker] = deque()
        self._queue: deque[Work] = deque()
        self._errors: list[BaseException] = []
        self._dismissed = False

    def all_busy(self) -> bool:
        """Whether no worker is free and none can be started."""
        return not self._idle and len(self._workers) >= self._executor.threads

    def submit(self, work: Work, finisher: Worker | None = None) -> None:
        """Give yielded work to a worker, ``finisher`` if it has none, or queue it. With the lock held."""
        if self.all_busy() and (finisher is None or finisher.job is not None):
            self._queue.append(work)
        else:
            job = self._begin(work)
            if job is not None:
                self._employ(job, finisher)
        if self._errors:
            self.error_surfaces = True

    def _begin(self, work: Work) -> tuple[Entity, Taken] | Task[Any] | None:
        if isinstance(work, Task):
            return work
        taken = self._executor._begin(work)
        return None if taken is None else (work, taken)

    def _employ(self, job: tuple[Entity, Taken] | Task[Any], finisher: Worker | None) -> None:
        if finisher is not None and finisher.job is None:
            finisher.job = job
        elif self._idle:
            worker = self._idle.popleft()
            worker.job = job
            worker.signal.set()
        else:
            worker = Worker(self._clock.signal())
            worker.job = job
            self._workers.append(worker)
            self._clock.start_thread(lambda: self._work(worker), f"{self._name}_{len(self._workers) - 1}")

    def _work(self, worker: Worker) -> None:
        while not self._dismissed or worker.job is not None:
            if worker.job is None:
                worker.signal.wait(None)
            else:
                self._run(worker.job)
                self._look_for_work(worker)

    def _run(self, job: tuple[Entity, Taken] | Task[Any]) -> None:
        try:
            if isinstance(job, Task):
                self._executor._run_task(job)
            else:
                self._executor._run(*job)
        except Exception as error:  # noqa: BLE001 -- kept for the thread that spins
            with self._lock:
                self._errors.append(error)
        except (KeyboardInterrupt, SystemExit):
            return  # lost, as in rclpy: a pool's thread has nobody to tell

    def _look_for_work(self, worker: Worker) -> None:
        with self._lock:
            worker.job = None
            while self._queue and worker.job is None:
                worker.job = self._begin(self._queue.popleft())
            if self.dispatches_itself:
                self._dispatch(worker)
            if worker.job is None:
                self._idle.append(worker)

    def _dispatch(self, worker: Worker) -> None:
        executor = self._executor
        while executor._context.ok() and not executor._is_shutdown and not self.error_surfaces:
            work = executor._next_work(self._clock.now())
            if work is None:
                return
            self.submit(work, worker)
        executor.wake()

    def raise_surfacing(self) -> None:
        """Raise the oldest exception of a callback, if one is due to surface."""
        with self._lock:
            if not self.error_surfaces:
                return
            error = self._errors.pop(0)
            self.error_surfaces = False
        raise error

    def dismiss(self) -> None:
        """Let every worker end once it has nothing to do."""
        with self._lock:
            self._dismissed = True
            for worker in self._workers:
                worker.signal.set()
