"""What a run of this lesson shows."""

from lessons.checks import SECOND, calls_of, is_called
from sim.trace.model import Window
from sim.trace.timeline import Timeline

SERVICE = "/dummy_server_srv"


def ticks_during_one_call(run: Timeline) -> int:
    """Whether ticks went on, came now and then, or not at all."""
    call = is_called(SERVICE).windows(run)[0]
    ticks = len(calls_of(run, "timer_callback", call))
    if not ticks:
        return 2
    return 0 if ticks * SECOND > call.length // 2 else 1


def ticks_after_the_answer(run: Timeline) -> int:
    """Whether all ticks came right after the answer, or one, or none.

    On real ROS 2 the next tick of the old rhythm may come right after the
    one that is late.
    """
    answered = is_called(SERVICE).windows(run)[0].end
    soon = Window(answered, answered + SECOND // 4)
    return (2, 1, 1, 0)[min(len(calls_of(run, "timer_callback", soon)), 3)]
