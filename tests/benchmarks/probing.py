"""What the probe costs a node on real rclpy: fresh processes with it and without it, that run in turn.

A console follows the probed one, as the probe does more then. The variable ``CBTUI_BENCHMARK_PYTHON`` names
the Python of another rclpy.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from selectors import DefaultSelector
from typing import NamedTuple

from sim.real.probe_link import ProbeLink
from sim.real.programs import watched_environment

_NODE = """
import sys, time
import rclpy
from rclpy.executors import SingleThreadedExecutor

def tick():
    global calls
    calls += 1

period, seconds = float(sys.argv[1]), float(sys.argv[2])
rclpy.init()
node = rclpy.create_node("counting")
node.create_timer(period, tick)
executor = SingleThreadedExecutor()
executor.add_node(node)
for _ in sys.stdin:
    calls, began, busy = 0, time.monotonic(), time.thread_time()
    while calls == 0 or time.monotonic() - began < seconds:
        executor.spin_once(timeout_sec=0.1)
    print((time.thread_time() - busy) / calls, calls / (time.monotonic() - began), flush=True)
"""
_PYTHON = os.environ.get("CBTUI_BENCHMARK_PYTHON", sys.executable)
_TURN = 0.25
"""Seconds that a node runs in turn: short, as the speed of the machine changes meanwhile."""
_TURNS = 8
_WARM_UP = 2
"""Turns that do not count."""
_ISOLATED = {"ROS_DOMAIN_ID": "77", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


class _Turn(NamedTuple):
    """What a node did in its turn."""

    busy: float
    """CPU seconds of a callback, of the thread that spins: a busy machine changes them little."""
    rate: float
    """Callbacks a second."""


def callback_cost(pairs: int) -> float:
    """The seconds of CPU time that the probe adds to a callback of a node that runs as fast as it can."""
    return statistics.median(probed.busy - plain.busy for plain, probed in _measured(0.0, pairs))


def slowing(pairs: int) -> float:
    """The share of CPU time that the probe adds to a callback of a timer of 1 ms."""
    return statistics.median(probed.busy / plain.busy - 1 for plain, probed in _measured(0.001, pairs))


def lost_callbacks(pairs: int) -> float:
    """The share of the callbacks of a timer of 1 ms that a node does not get to because of the probe."""
    return statistics.median(1 - probed.rate / plain.rate for plain, probed in _measured(0.001, pairs))


@cache
def _measured(period: float, pairs: int) -> list[tuple[_Turn, _Turn]]:
    """What so many pairs of processes did, the first without the probe, each as the median of its turns."""
    return [_pair(period) for _ in range(pairs)]


def _pair(period: float) -> tuple[_Turn, _Turn]:
    with _node(period, probed=False) as plain, _node(period, probed=True) as probed:
        turns = [(_turn(plain), _turn(probed)) for _ in range(_WARM_UP + _TURNS)][_WARM_UP:]
    both = [_Turn(*map(statistics.median, zip(*each, strict=True))) for each in zip(*turns, strict=True)]
    return both[0], both[1]


def _turn(node: "subprocess.Popen[str]") -> _Turn:
    assert node.stdin is not None
    assert node.stdout is not None
    node.stdin.write("\n")
    node.stdin.flush()
    return _Turn(*map(float, node.stdout.readline().split()))


@contextmanager
def _node(period: float, *, probed: bool) -> Iterator["subprocess.Popen[str]"]:
    """A node that waits for its turns."""
    with ExitStack() as held:
        folder = Path(held.enter_context(tempfile.TemporaryDirectory()))
        environment = watched_environment(_PYTHON, folder) | _ISOLATED
        if not probed:
            del environment["PYTHONPATH"]
        node = held.enter_context(
            subprocess.Popen(
                [_PYTHON, "-c", _NODE, str(period), str(_TURN)],
                env=environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        )
        held.callback(node.kill)
        if probed:
            threading.Thread(target=_follow, args=(folder / f"{node.pid}.sock",), daemon=True).start()
        yield node


def _follow(path: Path) -> None:
    """Read what a probe tells until its process is gone."""
    selector = DefaultSelector()
    link = ProbeLink(selector, lambda _: None)
    while not link.connect(path):
        time.sleep(0.01)
    while link.is_open:
        for key, _ in selector.select(0.1):
            with suppress(OSError):
                key.data()
