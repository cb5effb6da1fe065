"""What the probe costs a node on real rclpy: one with it and one without run in turn, for a moment each.

A console follows the probed one, as the probe does more then.
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
from pathlib import Path
from selectors import DefaultSelector

from sim.probes.on_path.cbtui_probe import FOLDER
from sim.real.probe_link import ProbeLink
from sim.real.programs import ON_PATH

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
    calls, began = 0, time.monotonic()
    while time.monotonic() - began < seconds:
        executor.spin_once(timeout_sec=0.1)
    print(calls / (time.monotonic() - began), flush=True)
"""
_TURN = 0.25
"""Seconds that a node runs in turn: short, as the speed of the machine changes meanwhile."""
_WARM_UP = 4
"""Turns that do not count."""
_DOMAIN = "77"


def callback_cost(seconds: int) -> float:
    """The seconds that the probe adds to a callback of a node that runs as fast as it can."""
    return statistics.median(1 / probed - 1 / plain for plain, probed in _rates(0.0, seconds))


def lost_callbacks(seconds: int) -> float:
    """The share of the callbacks of a timer of 1 ms that a node does not get to because of the probe."""
    return statistics.median(1 - probed / plain for plain, probed in _rates(0.001, seconds))


def _rates(period: float, seconds: int) -> list[tuple[float, float]]:
    """Callbacks a second without and with the probe, of each turn in so many seconds of both."""
    with _node(period, probed=False) as plain, _node(period, probed=True) as probed:
        turns = [(_rate(plain), _rate(probed)) for _ in range(_WARM_UP + round(seconds / _TURN))]
    return turns[_WARM_UP:]


def _rate(node: "subprocess.Popen[str]") -> float:
    """Callbacks a second in the node's turn."""
    assert node.stdin is not None
    assert node.stdout is not None
    node.stdin.write("\n")
    node.stdin.flush()
    return float(node.stdout.readline())


@contextmanager
def _node(period: float, *, probed: bool) -> Iterator["subprocess.Popen[str]"]:
    """A node that waits for its turns."""
    isolated = {"ROS_DOMAIN_ID": _DOMAIN, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    with ExitStack() as held:
        folder = held.enter_context(tempfile.TemporaryDirectory())
        watched = {"PYTHONPATH": str(ON_PATH), FOLDER: folder} if probed else {}
        node = held.enter_context(
            subprocess.Popen(
                [sys.executable, "-c", _NODE, str(period), str(_TURN)],
                env={**os.environ, **isolated, **watched},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        )
        held.callback(node.kill)
        if probed:
            socket = Path(folder) / f"{node.pid}.sock"
            threading.Thread(target=_follow, args=(socket,), daemon=True).start()
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
