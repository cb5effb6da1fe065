"""What the probe costs a node on real rclpy: the same node with and without it, in turn.

A console follows the probed ones, as the probe does more then.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
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

calls, period, seconds = 0, float(sys.argv[1]), float(sys.argv[2])
rclpy.init()
node = rclpy.create_node("counting")
node.create_timer(period, tick)
executor = SingleThreadedExecutor()
executor.add_node(node)

def spin_for(seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.1)

spin_for(1.0)
calls, began = 0, time.monotonic()
spin_for(seconds)
print(calls / (time.monotonic() - began), flush=True)
"""
_ROUNDS = 9
_DOMAIN = "77"


def callback_cost(seconds: int) -> float:
    """The seconds that the probe adds to a callback of a node that runs as fast as it can."""
    plain, probed = _rates(0.0, seconds)
    return 1 / probed - 1 / plain


def lost_callbacks(seconds: int) -> float:
    """The share of the callbacks of a timer of 1 ms that a node does not get to because of the probe."""
    plain, probed = _rates(0.001, seconds)
    return 1 - probed / plain


def _rates(period: float, seconds: int) -> tuple[float, float]:
    """Callbacks a second without and with the probe: the medians of runs taken in turn."""
    rounds = [
        (_rate(period, seconds, probed=False), _rate(period, seconds, probed=True)) for _ in range(_ROUNDS)
    ]
    return statistics.median(each[0] for each in rounds), statistics.median(each[1] for each in rounds)


def _rate(period: float, seconds: int, *, probed: bool) -> float:
    isolated = {"ROS_DOMAIN_ID": _DOMAIN, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    with tempfile.TemporaryDirectory() as folder:
        watched = {"PYTHONPATH": str(ON_PATH), FOLDER: folder} if probed else {}
        command = [sys.executable, "-c", _NODE, str(period), str(seconds)]
        with subprocess.Popen(
            command, env={**os.environ, **isolated, **watched}, stdout=subprocess.PIPE, text=True
        ) as node:
            if probed:
                socket = Path(folder) / f"{node.pid}.sock"
                threading.Thread(target=_follow, args=(socket,), daemon=True).start()
            told, _ = node.communicate()
    return float(told)


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
