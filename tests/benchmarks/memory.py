"""How the memory of a console grows with the run that it shows, measured in a process of its own."""

import subprocess
import sys

import psutil

from sim.trace.events import AnyEvent, decode, encode
from sim.trace.timeline import Timeline
from tests.benchmarks import seeking

_SETTLING = 60
"""Seconds of the run before the first measurement."""
_BATCH = 500
_MEGABYTE = 1_000_000


def added(seconds: int) -> float:
    """The megabytes that so many more seconds of the lesson add to a process which has a timeline of it."""
    asked = [sys.executable, "-m", __name__, str(seconds)]
    done = subprocess.run(asked, check=True, capture_output=True, text=True)
    return float(done.stdout)


def _grown(seconds: int) -> float:
    timeline = Timeline()
    settled: int | None = None
    batch: list[AnyEvent] = []
    for event in seeking.events(_SETTLING + seconds):
        batch.append(event)
        if len(batch) == _BATCH:
            # Coded and decoded, so that no two events share what they hold.
            timeline.extend(decode(encode(batch)))
            batch = []
            if settled is None and timeline.end >= _SETTLING * 1_000_000_000:
                settled = _resident()
    return _resident() - (settled or _resident())


def _resident() -> int:
    """The bytes of memory that this process has."""
    return psutil.Process().memory_info().rss


if __name__ == "__main__":
    print(_grown(int(sys.argv[1])) / _MEGABYTE)
