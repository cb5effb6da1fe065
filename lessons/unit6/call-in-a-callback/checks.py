"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    calls_of,
    is_called_often,
    log_says,
    never_stuck,
    requests_of,
    ticks_on_time,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

SERVICE = "/gripper"

CHECKS = (
    never_stuck(),
    is_called_often("pick", at_least=15),
    log_says("GRIPPER CLOSED", at_least=7),
    log_says("GRIPPER OPEN", at_least=7),
    ticks_on_time("heartbeat", 0.1),
)


def reply_of_the_first_call(run: Timeline) -> int:
    """Whether the reply came, the gripper never moved, or it did in vain."""
    first = requests_of(run, SERVICE)[0]
    pick = calls_of(run, "pick")[0]
    if pick.end is not None:
        return 0
    moved = calls_of(run, SERVICE, Window(first.sent, run.end))
    return 2 if any(span.end is not None for span in moved) else 1


def heartbeat_after_the_call(run: Timeline) -> int:
    """Whether the heart beat on, stopped for ever, or beat more slowly."""
    after = Window(requests_of(run, SERVICE)[0].sent, run.end)
    beats = len(calls_of(run, "heartbeat", after))
    if not beats:
        return 1
    return 0 if beats * SECOND > 1.8 * after.length else 2
