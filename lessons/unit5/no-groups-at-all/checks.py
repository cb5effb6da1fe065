"""What a run of this lesson shows."""

from lessons.checks import SECOND, calls_of, is_called
from sim.trace.model import Window
from sim.trace.timeline import Timeline

SERVICE = "/dummy_server_srv"


def ticks_during_one_call(run: Timeline) -> int:
    """Whether ticks were on time, late, or missing in the first call."""
    call = is_called(SERVICE).windows(run)[0]
    ticks = calls_of(run, "timer_callback", call)
    if not ticks:
        return 2
    late = max(tick.age for tick in ticks) > SECOND // 4
    return 1 if late or len(ticks) < 5 else 0


def ticks_among_three_calls(run: Timeline) -> int:
    """Whether no tick came among three calls, one by one, or many."""
    _, *three = is_called(SERVICE).windows(run)
    among = Window(three[0].start, max(call.end for call in three))
    ticks = len(calls_of(run, "timer_callback", among))
    if not ticks:
        return 0
    return 1 if ticks < len(three) else 2
