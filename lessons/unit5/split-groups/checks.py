"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    ROTATES,
    SECOND,
    calls_of,
    data_never_older,
    keeps_coming,
    never_overlap,
    rotations,
    turns,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

CHECKS = (
    keeps_coming("/odom", ROTATES, at_least=15),
    keeps_coming("/scan", ROTATES, at_least=15),
    data_never_older("/scan", "timer_callback", 0.3),
    turns(1),
    never_overlap("timer_callback"),
)


def sensors_while_rotating(run: Timeline) -> int:
    """Whether odom and scan waited, both ran on, or one of them did."""
    turn = rotations(run)[0]
    ran_on = [
        len(calls_of(run, topic, turn)) * SECOND > 10 * turn.length
        for topic in ("/odom", "/scan")
    ]
    if all(ran_on):
        return 1
    return 2 if any(ran_on) else 0


def ticks_of_the_rotation(run: Timeline) -> int:
    """Whether ticks ran beside the rotation, all after it, or one."""
    turn = rotations(run)[0]
    # The command to stop comes a little later to the robot than to its end.
    begun, ended = turn.start + SECOND // 10, turn.end - SECOND // 10
    if calls_of(run, "timer_callback", Window(begun, ended)):
        return 0
    soon = Window(ended, turn.end + SECOND // 4)
    return 2 if len(calls_of(run, "timer_callback", soon)) == 1 else 1
