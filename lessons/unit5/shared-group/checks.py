"""What a run of this lesson shows."""

from lessons.checks import SECOND, calls_of, rotations
from sim.trace.model import Window
from sim.trace.timeline import Timeline


def sensors_while_rotating(run: Timeline) -> int:
    """Whether odom and scan waited, ran on, or ran now and then."""
    turn = rotations(run)[0]
    calls = calls_of(run, "/odom", turn) + calls_of(run, "/scan", turn)
    if not calls:
        return 0
    return 1 if len(calls) * SECOND > 20 * turn.length else 2


def first_after_the_rotation(run: Timeline) -> int:
    """Whether a sensor's callback or the timer's came first."""
    turn = rotations(run)[0]
    middle = (turn.start + turn.end) // 2
    ended = next(
        call.end_at(run.end)
        for call in calls_of(run, "timer_callback")
        if call.start <= middle < call.end_at(run.end)
    )
    after = Window(ended, run.end)
    sensor = min(
        calls_of(run, topic, after)[0].start for topic in ("/odom", "/scan")
    )
    timer = calls_of(run, "timer_callback", after)[0].start
    if sensor == timer:
        return 2
    return 0 if sensor < timer else 1
