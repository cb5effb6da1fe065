"""What the rules' looks at a recording cost while it is read, and thus how long they keep a key waiting."""

import time
from functools import lru_cache

from cbtui.runs.live.findings import FindingsMonitor
from sim.trace.events import AnyEvent
from sim.trace.timeline import Timeline
from tests.benchmarks import seeking

_DELIVERED = 2000
"""Events that a replay delivers at once."""


def longest_look(seconds: int) -> float:
    """The seconds of processor that the dearest look takes while so long a recording is read at once."""
    timeline = Timeline()
    watch = FindingsMonitor(timeline, clock=lambda: 0.0)
    events = _events(seconds)
    took = []
    for start in range(0, len(events), _DELIVERED):
        timeline.extend(events[start : start + _DELIVERED])
        took.append(_timed(watch))
    began = time.process_time()
    watch.update()
    return max(*took, time.process_time() - began)


def _timed(watch: FindingsMonitor) -> float:
    began = time.process_time()
    watch.update_when_due()
    return time.process_time() - began


@lru_cache(maxsize=1)
def _events(seconds: int) -> list[AnyEvent]:
    return list(seeking.events(seconds))
