"""What a run of this lesson shows, and what a mended file must do."""

from lessons.checks import (
    SECOND,
    calls_of,
    every_call_answered,
    is_called_often,
    keeps_coming,
    requests_of,
    runs_long,
    ticks_on_time,
)
from sim.trace.timeline import Timeline

INSPECTS = runs_long("inspect_callback")

CHECKS = (
    every_call_answered(),
    keeps_coming("belt_callback", INSPECTS, at_least=1.6),
    ticks_on_time("belt_callback", 0.1),
    is_called_often("belt_callback", 25),
)


def belt_during_inspection(run: Timeline) -> int:
    """Whether the belt went on, stood still, or missed some steps."""
    inspection = INSPECTS.windows(run)[0]
    steps = len(calls_of(run, "belt_callback", inspection))
    if not steps:
        return 1
    return 0 if steps * SECOND >= 1.6 * inspection.length else 2


def second_answer(run: Timeline) -> int:
    """Whether the second of two calls was answered in 3 or in 6 s."""
    second = requests_of(run, "/inspect")[1]
    if second.replied is None:
        return 2
    return round((second.replied - second.sent) / (3 * SECOND)) - 1
