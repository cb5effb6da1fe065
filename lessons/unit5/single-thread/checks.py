"""What a run of this lesson shows."""

from lessons.checks import SECOND, calls_of, rotations
from sim.trace.timeline import Timeline


def sensors_while_rotating(run: Timeline) -> int:
    """Whether odom and scan ran on, now and then, or not at all."""
    turn = rotations(run)[0]
    calls = calls_of(run, "/odom", turn) + calls_of(run, "/scan", turn)
    if not calls:
        return 2
    return 0 if len(calls) * SECOND > 20 * turn.length else 1


def rotations_until_driving(run: Timeline) -> int:
    """Whether one rotation was enough, or two, or none of any number."""
    turns = rotations(run)
    if turns[-1].end >= run.end:
        return 2
    return min(len(turns), 2) - 1
