"""The worker threads of a MultiThreadedExecutor, and the queue of callbacks that wait for one.

Whatever is yielded goes into one queue and is begun in the order of yielding; if its group has let another
one in by then, it is not taken. For each a free worker is called, the one that has been idle longest first; a
new one starts only when none is idle. A worker that ends a callback takes the next of the queue, whoever was
called for it, as Python's own pools do (``_worker`` in ``concurrent.futures.thread``): it has the interpreter
still. If the queue is empty it looks for what is ready itself, so that a busy executor needs no hand-over.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING
from weakref import WeakMethod

from sim.clock import AutoResetEvent
from sim.ros.scheduling.cycle import Work
from sim.ros.scheduling.running import Begun, Started
from sim.ros.scheduling.waiting_ends import never

if TYPE_CHECKING:
    from sim.ros.scheduling.executors import MultiThreadedExecutor


# Kept from before sim.clock.stdlib puts the virtual one in its place.
_join = threading.Thread.join


class Worker:
    """A thread of the pool; ``called`` while it is on its way to begin something."""

    __slots__ = ("began_in", "called", "signal", "thread")

    def __init__(self, signal: AutoResetEvent) -> None:
        self.signal = signal
        self.called = False
        self.began_in = -1
        """The clock's turn in which it began its first callback, while that runs."""
        self.thread: threading.Thread | None = None


class WorkerPool:
    """At most ``executor.threads`` workers, started when needed. Its state is guarded by the host's lock."""

    def __init__(self, executor: MultiThreadedExecutor) -> None:
        self.dispatches_itself = False
        """Whether workers may look for their next callback themselves."""
        self.enough: Callable[[], bool] = never
        """Whether they may look no longer."""
        self.error_surfaces = False
        """Whether a callback's exception is due to come out of ``spin``."""
        self._executor = executor
        self._runner = executor._runner
        self._lock = executor._lock
        self._clock = executor._clock
        self._name = f"ThreadPoolExecutor-{next(executor._context.process.pool_numbers)}"
        self._workers: list[Worker] = []
        self._idle: deque[Worker] = deque()
        self._queue: deque[Work] = deque()
        self._coming = 0
        self._look_owed = False
        self._starting: Worker | None = None
        self._started = self._clock.auto_reset_event()
        self._errors: list[BaseException] = []
        self._dismissed = False
        self._living = 0
        self._end_signals: list[AutoResetEvent] = []
        executor._context.process.finish_pools.append(WeakMethod(self._finish))

    @property
    def _max_workers(self) -> int:
        """How many workers there can be, as Python's own pools tell it."""
        return self._executor.threads

    def all_busy(self) -> bool:
        """Whether no worker is free and none can be started."""
        if self._idle or self._coming > len(self._queue):
            return False
        return len(self._workers) >= self._executor.threads

    def all_begun(self) -> bool:
        """Whether all that workers were called for has begun; if not, the executor is woken when it has."""
        self._look_owed = self._starting is not None or self._claimed()
        return not self._look_owed

    def _claimed(self) -> bool:
        return self._coming > 0 and len(self._queue) > 0

    def submit(self, work: Work, _now: int) -> None:
        """Have yielded work wait for a worker, and call one if one is free. With the lock held."""
        self._queue.append(work)
        if len(self._queue) > self._coming:
            self._call_worker()
        self._surface_errors()

    def looks_itself(self) -> bool:
        """Whether a worker is on its way that will look for what is ready; an idle one is called."""
        if not self.dispatches_itself:
            return False
        if self._coming <= len(self._queue):
            if not self._idle or self.enough():
                return False
            self._call_worker()
        return True

    def _call_worker(self) -> None:
        if self._idle:
            worker = self._idle[self._clock.choose(len(self._idle))]
            self._idle.remove(worker)
            self._expect(worker)
            worker.signal.set()
        elif len(self._workers) < self._executor.threads:
            worker = Worker(self._clock.auto_reset_event())
            self._workers.append(worker)
            self._living += 1
            self._starting = worker
            self._executor._cycle.hold()
            self._expect(worker)
            self._clock.start_thread(lambda: self._work(worker), f"{self._name}_{len(self._workers) - 1}")

    def await_start(self) -> None:
        """If a worker was just started, let it go first: it begins, and works until it has to wait."""
        while self._starting is not None:
            self._started.wait(None)

    def _expect(self, worker: Worker) -> None:
        worker.called = True
        self._coming += 1

    def keep(self, error: BaseException) -> None:
        """Keep a callback's exception until the next callback is handed over. With the lock held."""
        self._errors.append(error)

    def _surface_errors(self) -> None:
        if self._errors:
            self.error_surfaces = True

    def _work(self, worker: Worker) -> None:
        worker.thread = threading.current_thread()
        self._executor._probe.works_for(self._executor.trace_id)
        try:
            while (started := self._next(worker)) is not None:
                self._run(started, worker)
        finally:
            self._leave()

    def _next(self, worker: Worker) -> Started | None:
        """Wait for the worker's next callback and start it; None once the pool is dismissed."""
        may_find = False
        while True:
            with self._lock:
                now = self._clock.now()
                begun = self._begin_queued(worker, now)
                others_go_first = begun is None and not may_find and self._clock.able > self._coming
                if begun is None and not others_go_first:
                    begun = self._begin_found(now)
                if begun is not None:
                    return self._runner.start(begun)
                if others_go_first:
                    self._expect(worker)
                elif self._dismissed:
                    return None
                else:
                    others_go_first = len(self._queue) > self._coming
                    if not others_go_first:
                        self._idle.append(worker)
            if others_go_first:
                self._clock.sleep(0)
            else:
                worker.signal.wait(None)
            if self.error_surfaces:
                self._clock.sleep(0)  # the thread that spins raises before the next callback begins
            may_find = True

    def _begin_queued(self, worker: Worker, now: int) -> Begun | None:
        """Begin the next in the queue, whoever was called for it."""
        if worker.called:
            worker.called = False
            self._coming -= 1
        begun = None
        while begun is None and self._queue:
            begun = self._runner.begin(self._queue.popleft(), now)
        if self._starting is not None or self._look_owed:
            self._tell_begun(worker)
        if begun is not None and self._coming == 0 and self._executor._cycle.would_find(now):
            self._executor._rouse()
        return begun

    def _tell_begun(self, worker: Worker) -> None:
        """Have the executor serve what it has found meanwhile, if it waits for workers to begin."""
        if self._starting is worker:
            worker.began_in = self._clock.turn
        if self._starting is worker or not self._claimed():
            self._starting = None
            self._started.set()
        if self._look_owed and self._starting is None and not self._claimed():
            self._executor._rouse()

    def _begin_found(self, now: int) -> Begun | None:
        """Begin the first of what is ready, and give the rest of its cycle to others."""
        if len(self._queue) > self._coming or not self._may_look():
            return None
        cycle = self._executor._cycle
        own = cycle.next(now)
        if own is None:
            return None
        if self._errors:  # they come out of what hands it over, before it begins
            self._queue.append(own)
            self._surface_errors()
            self._executor._rouse()
            return None
        finds = True
        while finds and not (self._starting or cycle.held):
            while not self._starting and (work := cycle.rest(now)) is not None:
                self.submit(work, now)
            finds = cycle.gather(now)
        if finds:
            self._executor._rouse()
        return self._runner.begin(own, now)

    def _may_look(self) -> bool:
        """Whether a worker may look for what is ready; else the thread that spins is told to."""
        if not self.dispatches_itself:
            return False
        executor = self._executor
        if self.enough() or self.error_surfaces or executor._is_shutdown or not executor._context.ok():
            executor._rouse()
            return False
        return True

    def _run(self, started: Started, worker: Worker) -> None:
        try:
            self._runner.run(started)
        except Exception as error:  # noqa: BLE001 -- kept for the thread that spins
            with self._lock:
                self.keep(error)
                # Who started the worker has been waiting for it, and only now looks for errors, unless the
                # worker has taken over what others were called for before.
                self.error_surfaces |= worker.began_in == self._clock.turn and not self._claimed()
        except (KeyboardInterrupt, SystemExit):
            return  # lost, as in rclpy: a pool's thread has nobody to tell
        finally:
            worker.began_in = -1

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

    def _finish(self) -> None:
        """Wait for what is begun or queued, as Python does for a pool once the main thread has ended."""
        if self._queue or len(self._idle) < len(self._workers):
            self.dismiss()
            self.wait_for_end()

    def _leave(self) -> None:
        """A worker has nothing more to do; whoever waits for the end of the last goes on."""
        self._clock.end_thread()
        with self._lock:
            self._living -= 1
            if self._living == 0:
                for signal in self._end_signals:
                    signal.set()

    def wait_for_end(self) -> None:
        """Wait until every worker's thread is gone, after ``dismiss``; a worker itself waits for nobody."""
        if any(worker.thread is threading.current_thread() for worker in self._workers):
            return
        ended = self._clock.auto_reset_event()
        with self._lock:
            self._end_signals.append(ended)
            if self._living == 0:
                ended.set()
        if ended.wait(None):
            for worker in self._workers:
                if worker.thread is not None:
                    _join(worker.thread)
