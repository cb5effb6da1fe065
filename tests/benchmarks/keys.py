"""How long a person waits from pressing a key until the screen shows what it did, in a console that runs."""

import random
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.benchmarks.console import RUNS, Console, lesson_opened, opened

_LESSON = "split-groups"
_BUSY = """
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class BusyNode(Node):
    def __init__(self):
        super().__init__("busy")
        self.create_timer(0.01, self.tick, MutuallyExclusiveCallbackGroup())
        self.create_timer(0.5, self.compute, MutuallyExclusiveCallbackGroup())

    def tick(self):
        pass

    def compute(self):
        while rclpy.ok():
            pass


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(BusyNode())
    executor.spin()


if __name__ == "__main__":
    main()
"""
_SETTLED = 3.0
"""Seconds of a run before the first key."""
_PAUSES = 0.05, 0.30
"""Seconds between what a key did and the next, so that keys fall anywhere between two frames."""
_BACK_AND_LIVE = (("[", rb"BACK"), ("0", rb"LIVE"))
"""Keys that draw every pane anew while the run goes on, and what the status line then says.

It comes with all panes but log and code, whose texts follow some milliseconds later.
"""


def in_a_lesson(presses: int) -> list[float]:
    """The seconds that each of so many keys took in a lesson with callbacks at 100 Hz."""
    return _waits(lesson_opened(_LESSON), presses)


def beside_a_busy_node(presses: int) -> list[float]:
    """The seconds that each took while the node's callback computes without end, on the real clock."""
    return _waits(_busy_node_opened(), presses)


def percentile(waits: list[float], share: float) -> float:
    """The least of the waits that so large a share of all stays within."""
    return sorted(waits)[round(share * (len(waits) - 1))]


@contextmanager
def _busy_node_opened() -> Iterator[Console]:
    with TemporaryDirectory() as folder:
        file = Path(folder) / "busy.py"
        file.write_text(_BUSY, encoding="utf-8")
        with opened("open", str(file)) as console:
            console.until(RUNS)
            yield console


def _waits(opening: AbstractContextManager[Console], presses: int) -> list[float]:
    chance = random.Random(presses)
    with opening as console:
        console.watch(_SETTLED)
        waits = []
        for number in range(max(1, presses)):
            key, shown = _BACK_AND_LIVE[number % 2]
            console.press(key)
            waits.append(console.until(shown))
            console.watch(chance.uniform(*_PAUSES))
    return waits
