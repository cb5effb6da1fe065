"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    ROTATES,
    SECOND,
    Check,
    Verdict,
    calls_of,
    data_never_older,
    keeps_coming,
    turns,
    whole_run,
)
from sim.trace.figures.concurrency import Concurrency
from sim.trace.timeline import Timeline

SENSORS = ("/odom", "/scan")


def _no_thread_too_many(run: Timeline) -> Verdict:
    most = max((each.threads for each in run.executors.values()), default=0)
    needed = Concurrency(run).peak(run.end)
    expected = f"no more than were ever needed at once: {needed}"
    return Verdict(0 < most <= needed, expected, f"{most}")


CHECKS = (
    keeps_coming("/odom", ROTATES, at_least=15),
    keeps_coming("/scan", ROTATES, at_least=15),
    data_never_older("/scan", "timer_callback", 0.2),
    turns(1),
    Check("no thread is too many", _no_thread_too_many),
)


def threads_needed(run: Timeline) -> int:
    """The most threads that ran callbacks at once: one is answer 0."""
    return Concurrency(run).peak(run.end) - 1


def calls_with_more_threads(run: Timeline) -> int:
    """Whether sensor messages were left waiting for want of a thread."""
    every = [call for topic in SENSORS for call in calls_of(run, topic)]
    waited = any(call.age > SECOND // 20 for call in every)
    entities = {call.entity for call in every}
    lost = any(run.drops_of(each, whole_run(run)) for each in entities)
    return 0 if waited or lost else 1
