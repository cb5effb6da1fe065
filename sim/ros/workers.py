"""The worker threads of a MultiThreadedExecutor, and the queue of callbacks that wait for one.

A yielded callback is given to a free worker, which begins it when it gets to run: if its group has let
another one in by then, it is not taken. The others wait in the queue, already handed out, in the order in
which they were yielded. The worker that has been idle longest is asked first, and a new one starts only when
none is idle. A worker that ends a callback looks for the next one itself, so that a busy executor needs no
hand-over between threads; unless callbacks given to other workers have yet to begin, for those go first.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any, TypeAlias

from sim.clock import Signal
from sim.ros.entity import Entity, Taken
from sim.ros.process import current_process
from sim.ros.task import Task

if TYPE_CHECKING:
    from sim.ros.executor import Work
    from sim.ros.executors import MultiThreadedExecutor

Begun: TypeAlias = "tuple[Entity, Taken] | Task[Any]"


class Worker:
    """A thread of the pool; ``job`` is what it was given and has not begun yet."""

    __slots__ = ("job", "signal")

    def __init__(self, signal: Signal) -> None:
        self.signal = signal
        self.job: Work | None = None


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
        self._name = f"ThreadPoolExecutor-{next(current_process().pool_numbers)}"
        self._workers: list[Worker] = []
        self._idle: deque[Worker] = deque()
        self._queue: deque[Work] = deque()
        self._given = 0
        self._look_owed = False
        self._errors: list[BaseException] = []
        self._dismissed = False

    def all_busy(self) -> bool:
        """Whether no worker is free and none can be started."""
        return not self._idle and len(self._workers) >= self._executor.threads

    def all_begun(self) -> bool:
        """Whether all that workers were given has begun; if not, the executor is woken when it has."""
        self._look_owed = self._given > 0
        return not self._look_owed

    def submit(self, work: Work) -> None:
        """Give yielded work to a free worker, or have it wait for one. With the lock held."""
        if self._idle:
            worker = self._idle.popleft()
            self._give(worker, work)
            worker.signal.set()
        elif len(self._workers) < self._executor.threads:
            worker = Worker(self._clock.signal())
            self._workers.append(worker)
            self._give(worker, work)
            self._clock.start_thread(lambda: self._work(worker), f"{self._name}_{len(self._workers) - 1}")
        else:
            self._queue.append(work)
        self._surface_errors()

    def _give(self, worker: Worker, work: Work) -> None:
        worker.job = work
        self._given += 1

    def _surface_errors(self) -> None:
        if self._errors:
            self.error_surfaces = True

    def _work(self, worker: Worker) -> None:
        while (begun := self._next(worker)) is not None:
            self._run(begun)

    def _next(self, worker: Worker) -> Begun | None:
        """Wait for the worker's next callback and begin it; None once the pool is dismissed."""
        while True:
            self._let_given_begin(worker)
            with self._lock:
                begun = self._begin_given(worker) or self._begin_queued() or self._begin_found()
                if begun is not None:
                    return begun
                if self._dismissed:
                    return None
                self._idle.append(worker)
            worker.signal.wait(None)

    def _let_given_begin(self, worker: Worker) -> None:
        """What was given to other workers was yielded before what waits in the queue, so it goes first."""
        while worker.job is None and self._queue and self._given:
            self._clock.sleep(0)

    def _begin(self, work: Work) -> Begun | None:
        if isinstance(work, Task):
            return work
        taken = self._executor._begin(work)
        return None if taken is None else (work, taken)

    def _begin_given(self, worker: Worker) -> Begun | None:
        work, worker.job = worker.job, None
        if work is None:
            return None
        self._given -= 1
        if self._look_owed and self._given == 0:
            self._executor.wake()
        return self._begin(work)

    def _begin_queued(self) -> Begun | None:
        begun = None
        while self._queue and begun is None:
            begun = self._begin(self._queue.popleft())
        if begun is not None and self._may_look():
            self._give_out_ready()
        return begun

    def _begin_found(self) -> Begun | None:
        """Begin the first of what is ready, and give the rest to others."""
        own = self._executor._next_work(self._clock.now()) if self._may_look() else None
        if own is None:
            return None
        self._surface_errors()
        self._give_out_ready()
        return self._begin(own)

    def _may_look(self) -> bool:
        """Whether a worker may look for what is ready; else the thread that spins is told to."""
        if not self.dispatches_itself:
            return False
        executor = self._executor
        if self.error_surfaces or executor._is_shutdown or not executor._context.ok():
            executor.wake()
            return False
        return True

    def _give_out_ready(self) -> None:
        while not self.error_surfaces:
            work = self._executor._next_work(self._clock.now())
            if work is None:
                return
            self.submit(work)
        self._executor.wake()

    def _run(self, begun: Begun) -> None:
        try:
            if isinstance(begun, Task):
                self._executor._run_task(begun)
            else:
                self._executor._run(*begun)
        except Exception as error:  # noqa: BLE001 -- kept for the thread that spins
            with self._lock:
                self._errors.append(error)
        except (KeyboardInterrupt, SystemExit):
            return  # lost, as in rclpy: a pool's thread has nobody to tell

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
