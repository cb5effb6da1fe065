"""Runs a program in a test on real threads: on wall time, or on time that passes while all of them wait."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import sim.ros.rclpy as rclpy
from sim.clock import PacedClock
from sim.ros.node.node import Node
from sim.ros.scheduling.executors import Executor, ExternalShutdownException
from tests.support.simulation import Simulation, installed, no_thread_left

LIMIT = 60.0
"""Seconds after which a wait that should end has failed: far more than the busiest machine needs."""


class ParallelClock(PacedClock):
    """Threads run at once, as on the machine; time passes only while every one of them waits on this clock.

    Times are exact however busy the machine is; what threads do in one moment they do in any order. The
    thread that makes the clock is one of its threads.
    """

    def __init__(self) -> None:
        super().__init__()
        self.changed = threading.Condition()
        self._now = 0
        self._threads = 1
        self._waits: list[_Wait] = []

    def now(self) -> int:
        """Nanoseconds that have passed."""
        return self._now

    def sleep(self, duration: int) -> None:
        """Let ``duration`` nanoseconds pass."""
        time.sleep(0)
        self.auto_reset_event().wait(self._now + duration)

    def auto_reset_event(self) -> "ParallelAutoResetEvent":  # type: ignore[override]
        """A new signal, not set."""
        return ParallelAutoResetEvent(self)

    def call_at(self, time: int, action: Callable[[], None]) -> None:
        """Run ``action`` on a thread of its own once ``time`` has come."""

        def run() -> None:
            self.auto_reset_event().wait(time)
            action()

        self.start_thread(run, "timer")

    def start_thread(self, target: Callable[[], None], name: str) -> None:
        """Start a thread that lives on this clock."""

        def run() -> None:
            try:
                target()
            finally:
                with self.changed:
                    self._threads -= 1
                    self._let_time_pass()

        with self.changed:
            self._threads += 1
        super().start_thread(run, name)

    def wait(self, deadline: int | None) -> "_Wait":
        """Begin to wait, with ``changed`` held."""
        begun = _Wait(deadline)
        self._waits.append(begun)
        self._let_time_pass()
        return begun

    def end(self, wait: "_Wait") -> None:
        """Let a thread go on, with ``changed`` held; from here on it counts as running."""
        self._waits.remove(wait)
        wait.is_over = True
        self.changed.notify_all()

    def _let_time_pass(self) -> None:
        dues = [each.deadline for each in self._waits if each.deadline is not None]
        if len(self._waits) < self._threads or not dues:
            return
        self._now = min(dues)
        for each in [each for each in self._waits if each.deadline == self._now]:
            self.end(each)


class _Wait:
    def __init__(self, deadline: int | None) -> None:
        self.deadline = deadline
        self.is_over = False


class ParallelAutoResetEvent:
    """A signal of a parallel clock."""

    def __init__(self, clock: ParallelClock) -> None:
        self._clock = clock
        self._is_set = False
        self._wait: _Wait | None = None

    def wait(self, deadline: int | None) -> bool:
        """Wait until set, or until the clock shows ``deadline``; True if it was set."""
        with self._clock.changed:
            if not self._is_set and (deadline is None or deadline > self._clock.now()):
                self._wait = begun = self._clock.wait(deadline)
                assert self._clock.changed.wait_for(lambda: begun.is_over, LIMIT), "the threads stand still"
                self._wait = None
            was_set, self._is_set = self._is_set, False
        return was_set

    def set(self) -> None:
        """Set the flag and let the thread that waits go on."""
        with self._clock.changed:
            self._is_set = True
            if self._wait is not None and not self._wait.is_over:
                self._clock.end(self._wait)


@contextmanager
def on_wall_time() -> Iterator[Simulation]:
    """A program's surroundings on the real clock."""
    with _on(PacedClock()) as simulation:
        yield simulation


@contextmanager
def on_parallel_time() -> Iterator[Simulation]:
    """A program's surroundings on real threads, its times exact."""
    with _on(ParallelClock()) as simulation:
        yield simulation


@contextmanager
def _on(clock: PacedClock) -> Iterator[Simulation]:
    simulation = Simulation(clock, "jazzy@7.1.12")
    with no_thread_left(), installed(simulation.host):
        yield simulation


def spin(node: Node, executor: Executor | None = None) -> None:
    """Spin until the program shuts down."""
    chosen = rclpy.get_global_executor() if executor is None else executor
    chosen.add_node(node)
    try:
        chosen.spin()
    except ExternalShutdownException:
        pass
    finally:
        chosen.shutdown()
