"""Runs a program on wall time in a test, ends its spinning after a while, and knows when time was short."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import sim.ros as rclpy
from sim.clock import RealClock
from sim.ros.executors import Executor, ExternalShutdownException
from sim.ros.node import Node
from tests.support.simulation import Simulation, installed, no_thread_left

_RunT = TypeVar("_RunT")

_CALM = 0.025
"""Seconds by which a thread that only sleeps may be late on a machine that has time."""
_ATTEMPTS = 6


def _always(_result: object) -> bool:
    return True


def in_calm(run: Callable[[], _RunT], began_well: Callable[[_RunT], bool] = _always) -> _RunT:
    """What ``run`` gives while the machine lets threads run when they are due; tried again until it does.

    ``began_well`` says whether what a run was to begin with was there when it should be.
    """
    for _ in range(_ATTEMPTS):
        with _lateness() as lateness:
            result = run()
        if max(lateness) < _CALM and began_well(result):
            return result
    raise AssertionError(f"no attempt of {_ATTEMPTS} began well and in calm; {max(lateness):.3f} s late")


@contextmanager
def _lateness() -> Iterator[list[float]]:
    """How late a thread was that slept for a moment again and again, in seconds."""
    late = [0.0]
    over = threading.Event()

    def sleep() -> None:
        while not over.is_set():
            due = time.monotonic() + 0.005
            time.sleep(0.005)
            late.append(time.monotonic() - due)

    thread = threading.Thread(target=sleep)
    thread.start()
    try:
        yield late
    finally:
        over.set()
        thread.join()


@contextmanager
def on_wall_time() -> Iterator[Simulation]:
    """A program's surroundings on the real clock."""
    simulation = Simulation(RealClock())
    with no_thread_left(), installed(simulation.host):
        yield simulation


def spin_for(node: Node, seconds: float, executor: Executor | None = None) -> None:
    """Spin until so many seconds have passed."""
    chosen = rclpy.get_global_executor() if executor is None else executor
    chosen.add_node(node)
    timer = threading.Timer(seconds, rclpy.shutdown)
    timer.start()
    try:
        chosen.spin()
    except ExternalShutdownException:
        pass
    finally:
        timer.join()
        chosen.shutdown()
