"""What a run of this lesson shows, and what a mended file must do."""

from lessons.checks import (
    SECOND,
    calls_of,
    every_call_answered,
    is_called_often,
    keeps_coming,
    runs_long,
    ticks_on_time,
    whole_run,
)
from sim.trace.timeline import Timeline

INSPECTS = runs_long("inspect_callback")

CHECKS = (
    keeps_coming("belt_callback", INSPECTS, at_least=1.6),
    ticks_on_time("belt_callback", 0.1),
    is_called_often("belt_callback", 25),
    every_call_answered(),
)


def belt_during_inspection(run: Timeline) -> int:
    """Whether the belt went on, stood still, or missed some steps."""
    inspection = INSPECTS.windows(run)[0]
    steps = len(calls_of(run, "belt_callback", inspection))
    if not steps:
        return 1
    return 0 if steps * SECOND >= 1.6 * inspection.length else 2


def threads_for_two_nodes(run: Timeline) -> int:
    """Whether the nodes' callbacks ran on one thread or on two."""
    used = [
        thread
        for thread in run.threads
        if run.spans_on(thread, whole_run(run))
    ]
    return 0 if len(used) == 1 else 1
