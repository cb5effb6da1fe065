"""The worker threads of a MultiThreadedExecutor, and the queue of callbacks that wait for a worker.

Yielded work goes into one queue and starts in the order of yielding; if its group admits another callback
by then, it is not taken. Each item calls a free worker, first the one that has been idle longest; a new
worker starts only if none is idle. A worker that ends a callback takes the next item of the queue,
whichever worker was called for it, as Python's own pools do (``_worker`` in ``concurrent.futures.thread``).
If the queue is empty, the worker looks for ready work itself, so that a busy executor needs no hand-over
between threads.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, Any
from weakref import WeakMethod

from sim.clock import AutoResetEvent
from sim.ros.scheduling.cycle import Work
from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.running import AdmittedWork, StartedWork
from sim.ros.scheduling.task import Task
from sim.ros.scheduling.waiting_ends import never
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.scheduling.executors import MultiThreadedExecutor


# Kept from before sim.clock.stdlib puts the virtual one in its place.
_join = threading.Thread.join


class Worker:
    """A thread of the pool; ``called``: it was woken to start queued work."""

    __slots__ = ("began_in", "called", "signal", "thread")

    def __init__(self, signal: AutoResetEvent) -> None:
        self.signal = signal
        self.called = False
        self.began_in = -1
        """The clock's turn in which the worker started its first callback, while that callback runs."""
        self.thread: threading.Thread | None = None


class WorkerPool:
    """At most ``executor.threads`` workers, started when needed. The host's lock guards the state."""

    def __init__(self, executor: MultiThreadedExecutor) -> None:
        self.dispatches_itself = False
        """Whether workers may find their next callback themselves."""
        self.should_stop: Callable[[], bool] = never
        """Whether workers have to stop looking for callbacks."""
        self.error_surfaces = False
        """Whether ``spin`` has to raise the exception of a callback."""
        self._executor = executor
        self._runner = executor._runner
        self._lock = executor._lock
        self._clock = executor._clock
        self._name = f"ThreadPoolExecutor-{next(executor._context.process.pool_numbers)}"
        self._workers: list[Worker] = []
        self._idle: deque[Worker] = deque()
        self._queue: deque[Work] = deque()
        self._called_workers = 0
        self._spinner_waits = False
        self._hands_over_again = executor._profile.hands_over_again
        self._handed_over_again = 0
        """How often work of the queue was handed over again since the queue was empty."""
        self._own: Work | None = None
        """What the worker that looks for work is about to begin."""
        self._starting: Worker | None = None
        self._started = self._clock.auto_reset_event()
        self._errors: list[BaseException] = []
        self._dismissed = False
        self._alive_workers = 0
        self._end_signals: list[AutoResetEvent] = []
        executor._context.process.finish_pools.append(WeakMethod(self._finish))

    @property
    def _max_workers(self) -> int:
        """The largest number of workers, by the name of Python's own pools."""
        return self._executor.threads

    def all_busy(self) -> bool:
        """Whether no worker is free, and none can be started."""
        if self._idle or self._called_workers > len(self._queue):
            return False
        return len(self._workers) >= self._executor.threads

    def may_serve(self) -> bool:
        """Whether found work may be served: all that workers were called for has begun, or need not have.

        If not, what begins wakes the executor later.
        """
        self._spinner_waits = self._starting is not None or (self._claimed() and not self.kept_busy())
        return not self._spinner_waits

    def may_go_ahead(self) -> bool:
        """Whether found work can be served before that; for a worker that it starts, the executor waits."""
        return self._hands_over_again and self._starting is None

    def kept_busy(self) -> bool:
        """Whether a message waits for a worker: then no wait of rclpy's executor lasts.

        The event handlers of the subscription are still in the wait set, and share the condition of its DDS
        reader, so the executor goes round, mostly until Python takes the interpreter away after 5 ms.
        """
        return self._hands_over_again and any(
            isinstance(each, Entity)
            and each.kind is EntityKind.SUBSCRIPTION
            and each.pending
            and each.callback_group.can_execute(each)
            for each in self._not_begun()
        )

    def _not_begun(self) -> list[Work]:
        return [*self._queue] if self._own is None else [self._own, *self._queue]

    def asked_again(self) -> list[Task[Any]]:
        """The queued tasks that await and have callbacks queued behind them, for they go on there, too."""
        last_callback, last_places = -1, {}
        for place, work in enumerate(self._queue):
            if isinstance(work, Task):
                last_places[work] = place
            else:
                last_callback = place
        return [task for task, place in last_places.items() if task._was_suspended and place < last_callback]

    def hand_over_again(self, fresh: Collection[Task[Any]]) -> bool:
        """Hand over again what no worker has begun, except for ``fresh``; return whether that starts one.

        Python's pool counts an idle worker less for each item, and starts one where none is left
        (``_adjust_thread_count``), also for what comes behind.
        """
        waits = self._not_begun() if self._hands_over_again and self._may_start() else ()
        waiting = sum(each not in fresh for each in waits)
        self._handed_over_again += waiting
        starts = waiting > 0 and (self._none_is_idle() or self._goes_round_in_vain())
        if starts:
            self._start_worker()
        return starts

    def _goes_round_in_vain(self) -> bool:
        """Whether the executor is kept busy, and each round takes one more idle worker and finds nothing."""
        return self.kept_busy() and not self._executor._cycle.would_find(self._clock.now())

    def _may_start(self) -> bool:
        return self._starting is None and len(self._workers) < self._executor.threads

    def _none_is_idle(self) -> bool:
        return self._handed_over_again > len(self._idle) + max(0, self._called_workers - len(self._queue))

    def _claimed(self) -> bool:
        return self._called_workers > 0 and len(self._queue) > 0

    def submit(self, work: Work, _now: int) -> None:
        """Queue yielded work, and call a worker if one is free. Called with the lock held."""
        self._queue.append(work)
        if len(self._queue) > self._called_workers:
            self._call_worker()
        if self._handed_over_again and self._may_start() and self._none_is_idle():
            self._start_worker()
        self._surface_errors()

    def worker_looks(self) -> bool:
        """Whether a called worker will look for ready work; an idle one is called for that."""
        if not self.dispatches_itself:
            return False
        if self._called_workers <= len(self._queue):
            if not self._idle or self.should_stop():
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
            self._start_worker()

    def _start_worker(self) -> None:
        worker = Worker(self._clock.auto_reset_event())
        self._workers.append(worker)
        self._alive_workers += 1
        self._starting = worker
        self._executor._cycle.hold()
        self._expect(worker)
        self._clock.start_thread(lambda: self._work(worker), f"{self._name}_{len(self._workers) - 1}")

    def await_start(self) -> None:
        """If a worker was just started, wait until it has started its work."""
        while self._starting is not None:
            self._started.wait(None)

    def _expect(self, worker: Worker) -> None:
        worker.called = True
        self._called_workers += 1

    def keep(self, error: BaseException) -> None:
        """Keep a callback's exception until the next callback is submitted. Called with the lock held."""
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

    def _next(self, worker: Worker) -> StartedWork | None:
        """Wait for the worker's next callback, and start it; None once the pool is dismissed."""
        may_find = False
        while True:
            with self._lock:
                now = self._clock.now()
                begun = self._begin_queued(worker, now)
                others_go_first = (
                    begun is None and not may_find and self._clock.runnable > self._called_workers
                )
                if begun is None and not others_go_first:
                    begun = self._begin_found(now)
                if begun is not None:
                    return self._runner.start(begun)
                if self._dismissed and not others_go_first:
                    return None
                others_go_first |= len(self._queue) > self._called_workers
                if others_go_first:
                    self._expect(worker)
                else:
                    self._idle.append(worker)
            if others_go_first:
                self._clock.sleep(0)
            else:
                worker.signal.wait(None)
            if self.error_surfaces:
                self._clock.sleep(0)  # the spinning thread raises before the next callback starts
            may_find = True

    def _begin_queued(self, worker: Worker, now: int) -> AdmittedWork | None:
        """Start the next work of the queue, whichever worker was called for it."""
        if worker.called:
            worker.called = False
            self._called_workers -= 1
        begun = None
        while begun is None and self._queue:
            work = self._queue.popleft()
            if not (isinstance(work, Task) and (work._settled() or work.executing())):
                begun = self._runner.begin(work, now)
        if not self._queue:
            self._handed_over_again = 0
        if self._starting is not None or self._spinner_waits:
            self._report_begun(worker)
        if begun is not None and self._called_workers == 0 and self._executor._cycle.would_find(now):
            self._executor._wake_spinner()
        return begun

    def _report_begun(self, worker: Worker) -> None:
        """Let the executor serve what it has found, if it waits until workers have started."""
        if self._starting is worker:
            worker.began_in = self._clock.turn
        if self._starting is worker or not self._claimed():
            if self._starting is not None and self._hands_over_again:
                self._surface_errors()  # of what others ran meanwhile
            self._starting = None
            self._started.set()
        if self._spinner_waits and self._starting is None and not self._claimed():
            self._executor._wake_spinner()

    def _begin_found(self, now: int) -> AdmittedWork | None:
        """Start the first ready callback, and give the rest of its cycle to other workers."""
        if len(self._queue) > self._called_workers or not self._may_look():
            return None
        cycle = self._executor._cycle
        own = cycle.next(now)
        if own is None:
            return None
        if self._errors:  # submitting work raises them before the work starts
            self._queue.append(own)
            self._surface_errors()
            self._executor._wake_spinner()
            return None
        finds = True
        self._own = own
        while finds and not (self._starting or cycle.held):
            while not self._starting and (work := cycle.next_found(now)) is not None:
                self.submit(work, now)
            # The spinning thread, which stays behind the start of a worker, begins no cycle meanwhile.
            finds = (self._hands_over_again and self._starting is not None) or cycle.gather(now)
        self._own = None
        if finds:
            self._executor._wake_spinner()
        return self._runner.begin(own, now)

    def _may_look(self) -> bool:
        """Whether a worker may look for ready work; otherwise the spinning thread is woken."""
        if not self.dispatches_itself:
            return False
        executor = self._executor
        if self.should_stop() or self.error_surfaces or executor._is_shutdown or not executor._context.ok():
            executor._wake_spinner()
            return False
        return True

    def _run(self, started: StartedWork, worker: Worker) -> None:
        try:
            self._runner.run(started)
        except Exception as error:  # noqa: BLE001 -- kept for the spinning thread
            with self._lock:
                self.keep(error)
                self.error_surfaces |= self._surfaces_now(worker)
        except BaseException:  # noqa: BLE001 -- lost, as in rclpy: the pool keeps it in a future
            return
        finally:
            worker.began_in = -1

    def _surfaces_now(self, worker: Worker) -> bool:
        """Whether the spinning thread raises the exception of a worker though it hands over nothing new.

        It waited for the worker that it started, and checks errors, unless that worker has taken over work
        that others were called for before.
        """
        waited_for = worker.began_in == self._clock.turn and not self._claimed()
        return waited_for or self._only_asks_again()

    def _only_asks_again(self) -> bool:
        """Whether the cycle that a callback's end begins hands over tasks that await, and nothing else."""
        awaits = any(isinstance(each, Task) and each._was_suspended for each in self._queue)
        return awaits and self._hands_over_again and not self._executor._cycle.would_find(self._clock.now())

    def raise_surfacing(self) -> None:
        """Raise the oldest exception of a callback, if one is due."""
        with self._lock:
            if not self.error_surfaces:
                return
            error = self._errors.pop(0)
            self.error_surfaces = False
            self._executor._probe.exception_surfaced(error)
        raise error

    def dismiss(self) -> None:
        """Let every worker end once it is idle."""
        with self._lock:
            self._dismissed = True
            for worker in self._workers:
                worker.signal.set()

    def _finish(self) -> None:
        """Wait for started and queued work, as Python does for a pool once the main thread has ended."""
        if self._queue or len(self._idle) < len(self._workers):
            self.dismiss()
            self.wait_for_end()

    def _leave(self) -> None:
        """A worker ends; the last one wakes the threads that wait for the end of the pool."""
        self._clock.end_thread()
        with self._lock:
            self._alive_workers -= 1
            if self._alive_workers == 0:
                for signal in self._end_signals:
                    signal.set()

    def wait_for_end(self) -> None:
        """Wait until all worker threads have ended, after ``dismiss``. On a worker itself, return at once."""
        if any(worker.thread is threading.current_thread() for worker in self._workers):
            return
        ended = self._clock.auto_reset_event()
        with self._lock:
            self._end_signals.append(ended)
            if self._alive_workers == 0:
                ended.set()
        if ended.wait(None):
            for worker in self._workers:
                if worker.thread is not None:
                    _join(worker.thread)
