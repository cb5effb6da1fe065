"""A pool whose threads race: the spinning thread goes through its cycles as rclpy's does, workers only run.

A usual pool takes the steps of rclpy's threads in the order that they mostly have, with few changes of
threads. Here each step is one of its own: the spinning thread hands over the tasks, gathers, waits, and hands
over what the wait found, and any other thread may come between two of these. So where a schedule chooses,
orders come that the usual pool cannot take.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterable
from typing import TYPE_CHECKING, Any

from sim.ros.scheduling.cycle import GATHERING, TASKS, WAITING, Cycle, Work
from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.running import AdmittedWork, StartedWork
from sim.ros.scheduling.task import Task
from sim.ros.scheduling.workers import Worker, WorkerPool

if TYPE_CHECKING:
    from sim.ros.scheduling.executors import MultiThreadedExecutor


class RacingCycle(Cycle):
    """The cycles of rclpy, a step at a time; after each one the spinning thread can be left."""

    go_on: Callable[[], None]
    """Ends the wait of the spinning thread, which then takes its next step."""
    looks: Callable[[], bool]
    """Looks for errors of workers behind what was handed over, and tells whether one comes out."""
    _there = -1
    """With which number the last of what is waited for became ready before the wait began."""
    _is_woken = False
    """Whether the guard condition was triggered since a wait ended."""
    _rests = False
    """Whether time may pass between a copy of the tasks and the gathering, as in one of many vain rounds."""

    @property
    def waits(self) -> bool:
        """Whether the executor waits for what was gathered, and finds nothing, or goes round in vain."""
        return self._rests or (self._following is WAITING and not self._wait_is_over(self._clock.now()))

    def next(self, now: int) -> Work | None:
        """Take the next step; return the work that it hands over, if it does."""
        if self.looks():
            self.go_on()
            return None
        work = self._serve(now)
        if work is None:
            self._rests = self._following is GATHERING and not self._rests and self._is_kept_busy()
            if self._rests:
                return None
            if self._find(now):
                work = self._serve(now)
            if work is None and (not self.waits or self._goes_round()):
                self.go_on()
        return work

    def _goes_round(self) -> bool:
        """Whether a message that waits for a worker ends the wait, which finds nothing."""
        self._is_woken = self._is_kept_busy()
        return self._is_woken

    def _is_kept_busy(self) -> bool:
        return self.pool is not None and self.pool.kept_busy() and self._clock.choose(2) > 0

    def _find(self, now: int) -> bool:
        if self._following is WAITING:
            return self._wait_is_over(now) and self._end_wait(now)
        if self._following is TASKS:
            self._ask_again()
            self._starts_worker()
            self._following = GATHERING
            return self._take_tasks()
        self._gather(deque())
        self._there = max(_arrived(self._awaited(self._ready(now))), default=-1)
        return False

    def _wait_is_over(self, now: int) -> bool:
        return self._is_woken or bool(self._awaited(self._ready(now)))

    def _end_wait(self, now: int) -> bool:
        """Find what the wait ended with: what ended it, and as much of what came since as is chosen.

        The end of rclpy's wait needs no interpreter, which its thread may get much later.
        """
        awaited = self._awaited(self._ready(now))
        arrived = _arrived(awaited)
        fewest = sum(number <= self._there for number in arrived) or (not self._is_woken)
        number = fewest + self._clock.choose(len(arrived) - fewest + 1)
        first = deque(each for each in awaited if each.readiness()[0] in arrived[:number])
        self._name(first)
        for each in first:
            each.leave_out(later=arrived[number - 1])
        self._is_woken = self._yielded = False
        self._following = TASKS
        return bool(first)

    def _serve(self, now: int) -> Work | None:
        due = self._due_tasks
        while due and (due[0]._settled() or due[0].executing()):
            due.popleft()
        return super()._serve(now)

    def add_task(self, task: Task[Any]) -> None:
        """Serve a task in the next cycle; a new one triggers the guard condition."""
        super().add_task(task)
        if not task._was_suspended:
            self.woken()

    def woken(self) -> None:
        """The guard condition is triggered."""
        self._is_woken = True
        self.go_on()


def _arrived(ready: Iterable[Entity]) -> list[int]:
    """The numbers with which entities, and the parts of actions, became ready."""
    return sorted(number for each in ready for number in each.readiness())


class RacingPool(WorkerPool):
    """Workers that take what the spinning thread has handed over, and look for nothing."""

    _handed_over = False
    """Whether work was handed over since errors were looked for."""

    def __init__(self, executor: MultiThreadedExecutor) -> None:
        super().__init__(executor)
        cycle = executor._cycle
        assert isinstance(cycle, RacingCycle)
        cycle.go_on, cycle.looks = executor._signal.set, self._looks

    def submit(self, work: Work, now: int) -> None:
        """Queue work; behind it errors are looked for, also those that come meanwhile."""
        super().submit(work, now)
        self._handed_over = True

    def _looks(self) -> bool:
        if self._handed_over:
            self._surface_errors()
        self._handed_over = False
        return self.error_surfaces

    def raise_surfacing(self) -> None:
        """Raise the oldest exception of a callback, if work was handed over."""
        with self._lock:
            self._looks()
        super().raise_surfacing()

    def worker_looks(self) -> bool:
        """No worker does."""
        return False

    def await_start(self) -> None:
        """The worker that was started may begin later."""

    def asked_again(self) -> list[Task[Any]]:
        """The tasks of the queue, for each cycle hands over all that do not run."""
        return [each for each in self._queue if isinstance(each, Task)] if self._hands_over_again else []

    def hand_over_again(self, _fresh: Collection[Task[Any]]) -> bool:
        """Count the callbacks that are handed over again, which do nothing else; no start is waited for."""
        waiting = sum(isinstance(each, Entity) for each in self._queue) if self._hands_over_again else 0
        if waiting:
            self._handed_over_again += waiting
            self._surface_errors()
            self._handed_over = True
            if self._may_start() and self._none_is_idle():
                self._start_worker()
        return False

    def _start_worker(self) -> None:
        super()._start_worker()
        self._starting = None

    def _next(self, worker: Worker) -> StartedWork | None:
        while True:
            with self._lock:
                waits = not self._queue
                begun = self._begin_queued(worker, self._clock.now())
                if begun is not None:
                    return self._runner.start(begun)
                if waits:
                    if self._dismissed:
                        return None
                    self._idle.append(worker)
            if waits:
                worker.signal.wait(None)

    def _begin_queued(self, worker: Worker, now: int) -> AdmittedWork | None:
        """Start the next work of the queue, unless it is done or refused."""
        if worker.called:
            worker.called = False
            self._called_workers -= 1
        work = self._queue.popleft() if self._queue else None
        if not self._queue:
            self._handed_over_again = 0
        if work is None or (isinstance(work, Task) and (work._settled() or work.executing())):
            return None
        begun = self._runner.begin(work, now)
        if isinstance(begun, Task):
            begun._executing = True
        return begun

    def _run(self, started: StartedWork, worker: Worker) -> None:
        try:
            super()._run(started, worker)
        finally:
            if isinstance(started, Task):
                started._executing = False

    def _surfaces_now(self, _worker: Worker) -> bool:
        return False
