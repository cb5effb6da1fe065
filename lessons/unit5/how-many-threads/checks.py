"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    ROTATES,
    SECOND,
    Check,
    Verdict,
    data_never_older,
    entities_named,
    keeps_coming,
    turns,
    whole_run,
)
from sim.trace.events import Reason
from sim.trace.timeline import Timeline

SENSORS = ("/odom", "/scan")
AT_ONCE = SECOND // 4
"""A callback that is over by then needs a thread, but not one for itself."""


def _needed(run: Timeline) -> int:
    """The most threads that had to run a callback at the same time."""
    spans = [
        span
        for each in run.entities
        for span in run.spans_of(each, whole_run(run))
    ]
    long = [
        span for span in spans if span.end_at(run.end) - span.start > AT_ONCE
    ]
    beside = (
        sum(other.start < span.start < other.end_at(run.end) for other in long)
        for span in spans
    )
    return 1 + max(beside, default=0)


def _no_thread_too_many(run: Timeline) -> Verdict:
    most = max((each.threads for each in run.executors.values()), default=0)
    needed = _needed(run)
    expected = f"no more than were ever needed at once: {needed}"
    return Verdict(0 < most <= needed, expected, f"{most}")


CHECKS = (
    keeps_coming("/odom", ROTATES, at_least=15),
    keeps_coming("/scan", ROTATES, at_least=15),
    data_never_older("/scan", "timer_callback", 0.3),
    turns(1),
    Check("no thread is too many", _no_thread_too_many),
)


def threads_needed(run: Timeline) -> int:
    """The most threads that ran callbacks at once: one is answer 0."""
    return _needed(run) - 1


def calls_with_more_threads(run: Timeline) -> int:
    """Whether sensor messages were left waiting for want of a thread."""
    waits = [
        wait
        for topic in SENSORS
        for entity in entities_named(run, topic)
        for wait in run.waits_of(entity, whole_run(run))
        if wait.reason is Reason.NO_FREE_WORKER
    ]
    ends = [run.end if wait.end is None else wait.end for wait in waits]
    starts = [wait.start for wait in waits]
    longest = max(map(int.__sub__, ends, starts), default=0)
    return 0 if longest > AT_ONCE else 1
